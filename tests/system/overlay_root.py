"""An overlay of the running root file system, which stays as it is: the disk of a machine to boot. Holds no test."""

import glob
import os
import shutil
import subprocess
import tempfile
import unittest
import uuid


def run(*command, check=True, timeout_s=120.0):
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, check=False)
    if check and done.returncode != 0:
        raise AssertionError(f"{' '.join(command)}: code {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def require_root_and(*tools):
    missing = [tool for tool in tools if shutil.which(tool) is None]
    if os.geteuid() != 0 or missing:
        raise unittest.SkipTest(f"a machine is booted by root only; missing: {missing or 'nothing'}")


class OverlayRoot:
    """mount(), close(); close() also when mount() has failed."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="slamd-system-")
        self.root = os.path.join(self.folder, "root")

    def mount(self):
        """SkipTest where the system does not permit it."""
        upper, work = (os.path.join(self.folder, name) for name in ("upper", "work"))
        for folder in (self.root, upper, work):
            os.mkdir(folder)
        mounted = run("mount", "-t", "overlay", "overlay", "-o", f"lowerdir=/,upperdir={upper},workdir={work}", self.root,
                      check=False)
        if mounted.returncode != 0:
            raise unittest.SkipTest(f"no overlay of the root file system: {mounted.stderr.strip()}")
        for wants in glob.glob(self.path("/etc/systemd/system/*.wants")):
            shutil.rmtree(wants)  # what this machine was asked to start, the other one was not
        os.symlink("/dev/null", self.path("/etc/systemd/system/timers.target"))
        os.remove(self.path("/etc/machine-id"))
        self.write("/etc/machine-id", uuid.uuid4().hex + "\n")

    def path(self, path):
        return self.root + path

    def write(self, path, text):
        os.makedirs(os.path.dirname(self.path(path)), exist_ok=True)
        with open(self.path(path), "w", encoding="utf-8") as file:
            file.write(text)

    def bring(self, folder, *packages):
        """The .deb files of the packages, as the machine names them."""
        shutil.copytree(folder, self.path("/debs"), dirs_exist_ok=True, ignore=lambda _, names:
                        [name for name in names if not name.endswith(".deb")])
        return [f"/debs/{name}" for name in os.listdir(self.path("/debs")) if name.split("_")[0] in packages]

    def close(self):
        run("umount", "-l", self.root, check=False)
        shutil.rmtree(self.folder, ignore_errors=True)
