"""A virtual machine with Debian's real-time kernel: QEMU without hardware's help, on an overlay of the running root. For function,
never for latency. Holds no test."""

import glob
import gzip
import json
import os
import shutil
import subprocess
import unittest

from overlay_root import OverlayRoot, require_root_and, run

META_PACKAGE = "linux-image-rt-amd64"
ROOT_MODULES = ("virtio_pci", "9pnet_virtio", "9p")  # what it takes to reach the root file system
LONGEST_TRIAL_S = 1500.0
PATIENCE_S = 2400.0  # with the boot, on a machine with other work

INIT = """#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
for module in {modules}; do /bin/busybox insmod /modules/$module || exit 1; done
/bin/busybox mount -t 9p -o trans=virtio,version=9p2000.L,cache=loose,msize=262144 root /root || exit 1
/bin/busybox umount /proc
exec /bin/busybox switch_root /root /lib/systemd/systemd
"""

# Part of the default target, so that it needs no word on the kernel's command line; the machine ends with it.
UNIT = f"""[Unit]
Description=what is to be tried in this machine
After=basic.target
[Service]
Type=oneshot
TimeoutStartSec={LONGEST_TRIAL_S:.0f}
ExecStart=/usr/bin/python3 -B /trial/trial.py /trial/report.json
ExecStopPost=/bin/systemctl poweroff --force
StandardOutput=file:/trial/output
StandardError=file:/trial/output
"""


class VirtualMachine(OverlayRoot):
    """prepare(), install(), try_out(), close()."""

    def __init__(self, cache):
        """cache: folder for the kernel's package, which is kept."""
        super().__init__()
        self.cache = cache
        self.kernel = None  # unpacked
        self.version = None

    def prepare(self):
        """SkipTest where the system does not permit a machine, or its kernel cannot be had."""
        require_root_and("qemu-system-x86_64", "busybox", "depmod", "modprobe", "systemd-nspawn")
        self.kernel = os.path.join(self.folder, "kernel")
        run("dpkg-deb", "-x", self.kernel_package(), self.kernel)
        self.version = os.path.basename(glob.glob(f"{self.kernel}/boot/vmlinuz-*")[0]).removeprefix("vmlinuz-")
        run("depmod", "-b", self.kernel, self.version)
        self.mount()
        if os.path.exists(self.path("/.dockerenv")):
            os.remove(self.path("/.dockerenv"))  # it is no container
        shutil.copytree(f"{self.kernel}/lib/modules", self.path("/lib/modules"), dirs_exist_ok=True)
        self.write("/etc/systemd/journald.conf.d/volatile.conf", "[Journal]\nStorage=volatile\n")  # a file over 9p is slow
        os.makedirs(self.path("/etc/tmpfiles.d"), exist_ok=True)
        os.symlink("/dev/null", self.path("/etc/tmpfiles.d/tmp.conf"))  # else the boot empties this system's /tmp, file by file

    def kernel_package(self):
        """Downloaded and not installed: nothing of the running system changes."""
        wanted = run("apt-cache", "depends", META_PACKAGE, check=False).stdout.split("Depends: ")
        if len(wanted) < 2:
            raise unittest.SkipTest(f"apt knows no {META_PACKAGE}: apt-get update?")
        name = wanted[1].split()[0]
        os.makedirs(self.cache, exist_ok=True)
        if not glob.glob(f"{self.cache}/{name}_*.deb"):
            done = subprocess.run(["apt-get", "download", name], cwd=self.cache, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise unittest.SkipTest(f"{name} cannot be downloaded: {done.stderr.strip()}")
        return glob.glob(f"{self.cache}/{name}_*.deb")[0]

    def install(self, folder, *packages):
        run("systemd-nspawn", "--quiet", "--directory", self.root, "--register=no", "--keep-unit", "--pipe", "apt-get", "install", "-y",
            "--no-install-recommends", "-o", "Dpkg::Use-Pty=0", *self.bring(folder, *packages), timeout_s=300.0)

    def initrd(self):
        tree = os.path.join(self.folder, "initrd")
        for folder in ("bin", "proc", "sys", "dev", "root", "modules"):
            os.makedirs(os.path.join(tree, folder))
        shutil.copy(shutil.which("busybox"), os.path.join(tree, "bin"))
        paths = []
        for module in ROOT_MODULES:
            lines = run("modprobe", "-d", self.kernel, "-S", self.version, "--show-depends", module).stdout.splitlines()
            paths += [path for path in (line.split()[1] for line in lines) if path not in paths]
        for path in paths:
            shutil.copy(path, os.path.join(tree, "modules"))
        with open(os.path.join(tree, "init"), "w", encoding="ascii") as init:
            init.write(INIT.format(modules=" ".join(map(os.path.basename, paths))))
            os.fchmod(init.fileno(), 0o755)
        names = "\n".join(os.path.relpath(os.path.join(at, name), tree) for at, dirs, files in os.walk(tree) for name in dirs + files)
        archive = subprocess.run(["busybox", "cpio", "-o", "-H", "newc"], cwd=tree, input=names.encode(), capture_output=True, check=True)
        image = os.path.join(self.folder, "initrd.gz")
        with gzip.open(image, "wb", compresslevel=1) as file:
            file.write(archive.stdout)
        return image

    def try_out(self, *files):
        """Boots, runs the first file (Python) as root with the others beside it, and gives the JSON that it has written."""
        os.makedirs(self.path("/trial"))
        for file in files:
            shutil.copy(file, self.path("/trial"))
        os.rename(self.path(f"/trial/{os.path.basename(files[0])}"), self.path("/trial/trial.py"))
        self.write("/etc/systemd/system/trial.service", UNIT)
        os.makedirs(self.path("/etc/systemd/system/multi-user.target.wants"))
        os.symlink("/etc/systemd/system/trial.service", self.path("/etc/systemd/system/multi-user.target.wants/trial.service"))
        console = os.path.join(self.folder, "console")
        command = ["qemu-system-x86_64", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m", "1536", "-nodefaults",
                   "-no-user-config", "-display", "none", "-no-reboot", "-serial", f"file:{console}",
                   "-kernel", f"{self.kernel}/boot/vmlinuz-{self.version}", "-initrd", self.initrd(),
                   "-virtfs", f"local,path={self.root},mount_tag=root,security_model=passthrough,multidevs=remap",
                   "-append", "console=ttyS0 systemd.show_status=1 panic=-1 systemd.unit=multi-user.target"]
        try:
            run(*command, timeout_s=PATIENCE_S)
        except subprocess.TimeoutExpired as slow:
            raise AssertionError(f"not done within {PATIENCE_S} s; {self.told(console)}") from slow
        if not os.path.exists(self.path("/trial/report.json")):
            raise AssertionError(self.told(console))
        with open(self.path("/trial/report.json"), encoding="utf-8") as file:
            return json.load(file)

    def told(self, console):
        """The ends of what the trial and the kernel said."""
        texts = []
        for path in (self.path("/trial/output"), console):
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as file:
                    texts.append(file.read()[-3000:])
        return "\n".join(texts)
