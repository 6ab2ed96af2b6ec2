"""The package under a real-time kernel, with the limits that a container cannot show and the IMU board on a real USB bus with a real
udev (dummy_hcd): one boot of a virtual machine, whose report is judged here."""

import os
import unittest

from virtual_machine import VirtualMachine

HERE = os.path.dirname(os.path.abspath(__file__))
SERIAL = "E6617C93E3428A2F"


class RealTimeKernelTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        machine = VirtualMachine(os.environ["SLAMD_KERNELS"])
        cls.addClassCleanup(machine.close)
        machine.prepare()
        machine.install(os.environ["SLAMD_PACKAGES"], "slamd")
        cls.report = machine.try_out(os.path.join(HERE, "real_time_trial.py"), os.path.join(HERE, "..", "usb", "imu_frames.py"))

    def log(self):
        return self.report["log"]

    def test_the_kernel_is_preemptible_and_has_control_groups_of_version_2_alone(self):
        kernel = self.report["kernel"]
        self.assertIn("PREEMPT_RT", kernel["version"])
        self.assertTrue(kernel["is_real_time"])
        self.assertEqual(kernel["cgroups"], ["cgroup2"])

    def test_udev_gives_the_board_its_stable_names(self):
        port = self.report["port"]
        self.assertEqual(port["names"], ["/dev/slamd-imu", f"/dev/slamd-imu-{SERIAL}"])
        self.assertEqual(port["target"], "/dev/ttyACM0")
        self.assertIn("ID_MM_DEVICE_IGNORE=1", port["udev"])

    def test_the_service_starts_and_reads_the_board(self):
        self.assertEqual(self.report["start"], 0, self.log())
        self.assertTrue(self.report["reads"], self.log())

    def test_the_limits_alone_permit_real_time_and_locked_memory(self):
        process = self.report["process"]
        self.assertEqual(int(process["status"]["CapEff"], 16), 0)
        self.assertNotEqual(process["status"]["Uid"].split()[0], "0")
        self.assertEqual(process["status"]["Seccomp"], "2")
        self.assertEqual(process["limits"], {"Max realtime priority": ["80", "80"], "Max locked memory": ["unlimited", "unlimited"]})
        self.assertGreater(int(process["status"]["VmLck"].split()[0]), 20_000)
        for name, priority in (("slamd-imu", 60), ("slamd-lidar", 50), ("slamd-estimator", 40)):
            self.assertEqual(process["threads"][name], [os.SCHED_FIFO, priority], name)

    def test_the_limit_of_idle_states_is_open_and_a_limit_of_memory_is_in_force(self):
        self.assertIn("/dev/cpu_dma_latency", self.report["process"]["devices"])
        self.assertEqual(int(self.report["process"]["memory_max"]), 768 << 20)

    def test_pulled_out_and_plugged_in_again_the_board_is_read_again(self):
        self.assertTrue(self.report["absent"], self.log())
        self.assertTrue(self.report["name_gone"])
        self.assertTrue(self.report["reads_again"], self.log())
        self.assertEqual(self.report["restarts"], "0")

    def test_plugged_in_the_board_starts_a_service_that_is_enabled_and_no_other(self):
        self.assertEqual(self.report["pulled_in"], [False, True], self.log())

    def test_the_check_of_the_machine_has_nothing_against_this_kernel(self):
        self.assertRegex(self.report["rt_check"], r"(?m)^right +kernel .*PREEMPT_RT")

    def test_it_stops_in_order(self):
        self.assertEqual(self.report["stop"], [0, "success"])


if __name__ == "__main__":
    unittest.main()
