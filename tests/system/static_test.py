"""What can be said of the units, the manual pages and the packages without starting anything."""

import glob
import os
import re
import shutil
import subprocess
import tempfile
import unittest

UNITS = os.environ["SLAMD_UNITS"]
SLAMD = os.environ["SLAMD"]
PACKAGES = os.environ["SLAMD_PACKAGES"]
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120, check=False)


def need(tool):
    if shutil.which(tool) is None:
        raise unittest.SkipTest(f"{tool} is not installed")


class Units(unittest.TestCase):
    def setUp(self):
        """The units as made, but of the program as built: verify wants it to be there."""
        need("systemd-analyze")
        self.folder = tempfile.mkdtemp(prefix="slamd-units-")
        self.addCleanup(shutil.rmtree, self.folder)
        for path in glob.glob(os.path.join(UNITS, "slamd*.*")):
            with open(path, encoding="utf-8") as unit:
                text = unit.read().replace("/usr/bin/slamd", SLAMD)
            with open(os.path.join(self.folder, os.path.basename(path)), "w", encoding="utf-8") as unit:
                unit.write(text)

    def paths(self, *names):
        return [os.path.join(self.folder, name) for name in names]

    def test_verify_has_nothing_to_say(self):
        for names in (("slamd.service", "slamd.socket"), ("slamd@.service", "slamd@.socket")):
            result = run("systemd-analyze", "verify", "--man=no", *self.paths(*names))
            self.assertEqual((result.returncode, result.stdout), (0, ""))

    def test_verify_would_say_something_of_a_wrong_key(self):
        with open(self.paths("slamd.service")[0], "a", encoding="utf-8") as unit:
            unit.write("[Service]\nProtectEverything=yes\n")
        self.assertIn("ProtectEverything", run("systemd-analyze", "verify", "--man=no", *self.paths("slamd.service")).stdout)

    def test_exposure_is_at_most_1_5(self):
        for name in ("slamd.service", "slamd@.service"):
            result = run("systemd-analyze", "security", "--offline=true", "--threshold=15", *self.paths(name))
            self.assertEqual(result.returncode, 0, result.stdout)
            self.assertIn("Overall exposure level", result.stdout)

    def test_users_and_folders_are_well_formed(self):
        need("systemd-sysusers")
        for tool, name in (("systemd-sysusers", "sysusers.conf"), ("systemd-tmpfiles", "tmpfiles.conf")):
            root = os.path.join(self.folder, tool)
            os.makedirs(os.path.join(root, "etc"))
            for line in ("dialout:x:20:", "plugdev:x:46:", "slamd:x:990:"):
                with open(os.path.join(root, "etc/group"), "a", encoding="utf-8") as group:
                    group.write(line + "\n")
            with open(os.path.join(root, "etc/passwd"), "w", encoding="utf-8") as passwd:
                passwd.write("slamd:x:990:990::/:/bin/false\n" if tool == "systemd-tmpfiles" else "")
            command = [tool, f"--root={root}", os.path.join(ROOT, "systemd", name)]
            result = run(*command, *(["--create"] if tool == "systemd-tmpfiles" else []))
            self.assertEqual(result.returncode, 0, result.stdout)
        with open(os.path.join(self.folder, "systemd-sysusers/etc/group"), encoding="utf-8") as group:
            groups = group.read()
        self.assertIn("dialout:x:20:slamd", groups)
        self.assertIn("\nslamd-control:", groups)
        self.assertTrue(os.path.isdir(os.path.join(self.folder, "systemd-tmpfiles/run/slamd")))


class ManualPages(unittest.TestCase):
    def test_they_format_without_a_warning(self):
        need("man")
        pages = glob.glob(os.path.join(os.path.dirname(UNITS), "docs/man/*.gz"))
        self.assertEqual(len(pages), 7)
        for page in pages:
            result = subprocess.run(["man", "--warnings", "--local-file", page], capture_output=True, text=True, check=False,
                                    env={**os.environ, "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "100"})
            self.assertEqual((result.returncode, result.stderr), (0, ""), page)
            self.assertIn("NAME", result.stdout)


class Packages(unittest.TestCase):
    def package(self, name):
        found = glob.glob(os.path.join(PACKAGES, f"{name}_*.deb"))
        self.assertEqual(len(found), 1, name)
        return found[0]

    def unpack(self, *names):
        folder = tempfile.mkdtemp(prefix="slamd-package-")
        self.addCleanup(shutil.rmtree, folder)
        for name in names:
            self.assertEqual(run("dpkg-deb", "-x", self.package(name), folder).returncode, 0)
        return folder

    def test_lintian_finds_no_error(self):
        need("lintian")
        packages = [self.package(name) for name in ("slamd", "libslamd0", "slamd-dev", "slamd-firmware", "python3-slamd")]
        result = run("lintian", "--fail-on", "error", "--allow-root", *packages)
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_the_python_package_is_the_client(self):
        folder = os.path.join(self.unpack("python3-slamd"), "usr/lib/python3/dist-packages")
        result = run("/usr/bin/env", f"PYTHONPATH={folder}", "python3", "-B", "-c", "import slamd; print(slamd.__all__)")
        self.assertIn("PosePage", result.stdout)

    def test_the_library_exports_what_its_header_says_and_nothing_else(self):
        root = self.unpack("libslamd0", "slamd-dev")
        library = glob.glob(os.path.join(root, "usr/lib/*/libslamd.so.0"))[0]
        exported = run("nm", "-D", "--defined-only", "--format=posix", library).stdout.splitlines()
        with open(os.path.join(root, "usr/include/slamd/client.h"), encoding="utf-8") as header:
            declared = set(re.findall(r"^[a-z].*?\b(slamd_\w+)\(", header.read(), re.MULTILINE))
        self.assertEqual({line.split("@")[0] for line in exported if "@@SLAMD_0" in line}, declared)
        self.assertEqual(len(exported), len(declared) + 1, "the version's own symbol besides")
        self.assertGreater(len(declared), 10)

    def test_the_examples_build_by_pkg_config_and_by_cmake(self):
        root = self.unpack("libslamd0", "slamd-dev")
        libraries = glob.glob(os.path.join(root, "usr/lib/*"))[0]
        examples = os.path.join(root, "usr/share/doc/slamd-dev/examples")
        flags = run("env", f"PKG_CONFIG_PATH={libraries}/pkgconfig", "pkg-config", f"--define-variable=prefix={root}/usr",
                    "--cflags", "--libs", "slamd").stdout.split()
        for command in (("cc", "-std=c99", "-pedantic-errors", "-Wall", "-Werror", f"{examples}/follow.c", *flags,
                         "-o", f"{root}/follow"),
                        ("c++", "-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"{examples}/save_map.cpp", *flags,
                         "-o", f"{root}/save_map"),
                        ("cmake", "-S", examples, "-B", f"{root}/build", f"-Dslamd_DIR={libraries}/cmake/slamd"),
                        ("cmake", "--build", f"{root}/build")):
            result = run(*command)
            self.assertEqual(result.returncode, 0, result.stdout)
        for program in ("follow", "build/follow", "save_map map.ply", "build/save_map map.ply"):
            result = run("env", f"LD_LIBRARY_PATH={libraries}", *f"{root}/{program} /none/slamd.sock".split())
            self.assertEqual(result.returncode, 1)
            self.assertIn("/none/slamd.sock: No such file or directory", result.stdout)


if __name__ == "__main__":
    unittest.main()
