"""Installation, upgrade, removal and purge of the package on a booted machine, without sensors."""

import os
import unittest

from machine import Machine

PACKAGES = os.environ["SLAMD_PACKAGES"]
CONFIG = "/etc/slamd/slamd.yaml"
MAP = "/var/lib/slamd/maps/yard.pcd"


class PackageTest(unittest.TestCase):
    def setUp(self):
        self.machine = Machine()
        self.addCleanup(self.machine.close)
        self.machine.prepare()
        self.machine.boot()

    def exists(self, path):
        return self.machine.call("test", "-e", path, check=False).returncode == 0

    def test_an_upgrade_keeps_config_maps_and_the_running_daemon_and_a_purge_removes_them(self):
        machine = self.machine
        machine.install(PACKAGES, "slamd", "slamd-firmware")
        machine.call("systemctl", "enable", "--now", "slamd")
        machine.write(CONFIG, "log:\n  repeat_period_s: 7\n")
        machine.call("runuser", "-u", "slamd", "--", "touch", MAP)
        pid = machine.show("slamd", "MainPID")

        said = machine.call("sh", "-c", "dpkg --force-confold -i /debs/slamd_*.deb").stdout
        self.assertIn("systemctl restart slamd", said)
        self.assertIn("repeat_period_s: 7", machine.call("cat", CONFIG).stdout)
        self.assertTrue(self.exists(MAP))
        self.assertEqual(machine.show("slamd", "MainPID"), pid, "a vehicle may be driving")
        self.assertEqual(machine.show("slamd", "ActiveState"), "active")

        machine.call("apt-get", "remove", "-y", "slamd")
        self.assertFalse(self.exists("/usr/bin/slamd"))
        self.assertNotEqual(machine.show("slamd", "ActiveState"), "active")
        self.assertTrue(self.exists(CONFIG) and self.exists(MAP), "only a purge removes them")

        machine.call("apt-get", "purge", "-y", "slamd")
        self.assertEqual([path for path in ("/etc/slamd", "/var/lib/slamd", "/run/slamd") if self.exists(path)], [])
        self.assertEqual(machine.call("find", "/etc/systemd/system", "-name", "slamd*").stdout, "")


if __name__ == "__main__":
    unittest.main()
