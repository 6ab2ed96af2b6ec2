"""Exit codes, messages and the order of start and stop of the real binary, without any sensor."""

import os
import signal
import socket
import subprocess
import unittest

from harness import SLAMD, EndToEndTest


def run(*arguments):
    return subprocess.run([SLAMD, *arguments], capture_output=True, text=True, timeout=60, check=False)


class CommandLine(EndToEndTest):
    def write(self, text):
        with open(self.path("f.yaml"), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path("f.yaml")

    def test_check_of_a_good_file_says_nothing_and_exits_with_0(self):
        result = run("--config", self.write("imu:\n  device: /dev/ttyACM7\n"), "--check")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_check_of_a_bad_file_names_every_fault_with_its_line_and_exits_with_2(self):
        path = self.write("imu:\n  devise: x\nlidar:\n  port: 70000\n")
        result = run("--config", path, "--check")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr.splitlines(),
                         [f"{path}:2: imu.devise: unknown key", f"{path}:4: lidar.port: must be in 1 .. 65535"])

    def test_a_bad_file_keeps_the_daemon_from_starting(self):
        result = run("--config", self.write("nonsense: 1\n"))
        self.assertEqual(result.returncode, 2)

    def test_the_printed_configuration_is_effective_and_reads_back(self):
        path = self.write("imu:\n  device: /dev/ttyACM7\n")
        printed = run("--config", path, "--set", "lidar.port=2400", "--print-config")
        self.assertEqual(printed.returncode, 0)
        self.assertIn("/dev/ttyACM7", printed.stdout)
        again = run("--config", self.write(printed.stdout), "--print-config")
        self.assertEqual(again.stdout, printed.stdout)

    def test_a_wrong_command_line_exits_with_2(self):
        self.assertEqual(run("--no-such-option").returncode, 2)
        self.assertEqual(run("--set", "imu.devise=1", "--check").returncode, 2)


class StartAndStop(EndToEndTest):
    def test_without_any_sensor_it_runs_answers_and_says_what_is_missing(self):
        daemon = self.start_daemon()
        self.assertEqual(self.client.status()["pose"]["status"], "INITIALISING")
        self.await_value("the log", lambda: "imu state=absent" in daemon.output(), 30.0)
        self.assert_stops_cleanly(daemon)

    def test_sigterm_and_sigint_end_it_with_0_and_remove_the_socket(self):
        for signal_number in (signal.SIGTERM, signal.SIGINT):
            daemon = self.start_daemon()
            self.client.close()
            daemon.send(signal_number)
            self.assertEqual(daemon.wait(30.0), 0, daemon.output())
            self.assertFalse(os.path.exists(self.path("slamd.sock")))

    def test_what_a_killed_daemon_leaves_does_not_keep_the_next_one_from_starting(self):
        killed = self.start_daemon()
        self.client.close()
        killed.send(signal.SIGKILL)
        killed.wait(30.0)
        self.assertTrue(os.path.exists(self.path("slamd.sock")), "nobody was there to remove it")
        daemon = self.start_daemon()
        self.assertEqual(self.client.status()["pose"]["status"], "INITIALISING")
        self.assert_stops_cleanly(daemon)
        self.assertFalse(os.path.exists(self.path("slamd.sock")))

    def test_a_port_in_use_is_a_failed_start_with_its_reason(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as blocker:
            blocker.bind(("127.0.0.1", self.port))
            daemon = self.start("slamd", self.daemon_arguments())
            self.assertEqual(daemon.wait(60.0), 1)
        self.assertIn("port is in use", daemon.output())

    def test_a_second_daemon_on_the_same_socket_is_refused_and_the_first_goes_on(self):
        first = self.start_daemon()
        self.port, self.position_port = self.port + 1, self.position_port + 1
        second = self.start("slamd", self.daemon_arguments())
        self.assertEqual(second.wait(60.0), 1, second.output())
        self.assertIn("pose", self.client.status())
        self.assert_stops_cleanly(first)


if __name__ == "__main__":
    unittest.main()
