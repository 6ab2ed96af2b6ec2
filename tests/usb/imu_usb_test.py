"""The IMU read straight from its USB endpoint by the real programs: imu-monitor --usb, and slamd with imu.source usb.
Runs under umockdev-wrapper; IMU_MONITOR and SLAMD name the programs.
"""
import json
import os
import re
import signal
import socket
import subprocess
import tempfile
import time
import unittest

from imu_board import ImuBoard
from usb_bus import Bus


class MonitorTest(unittest.TestCase):
    def setUp(self):
        self.bus = Bus()

    def run_monitor(self, *arguments):
        return subprocess.run([os.environ["IMU_MONITOR"], "--usb", *arguments], capture_output=True, text=True, timeout=60,
                              check=False, env=self.bus.environment)

    def test_samples_come_without_a_tty(self):
        self.bus.plug("2", ImuBoard())
        run = self.run_monitor("--seconds", "2.5")
        self.assertEqual(run.returncode, 0, run.stderr)
        rate = float(re.search(r"([\d.]+) Hz", run.stdout.splitlines()[1]).group(1))
        self.assertAlmostEqual(rate, 208.0, delta=4.0)
        self.assertIn("gaps 0 (0 missing)", run.stdout)
        self.assertRegex(run.stdout, r"\|g\| 9\.80\d\d m/s\^2")

    def test_gaps_are_counted_by_sequence(self):
        board = ImuBoard()
        first = int((time.monotonic() - board.start + 1.0) * board.rate_hz)  # lost about half a second after the start
        board.skip = set(range(first, first + 7))
        self.bus.plug("2", board)
        run = self.run_monitor("--seconds", "2.2")
        self.assertIn("gaps 1 (7 missing)", run.stdout)

    def test_of_several_boards_the_serial_number_chooses(self):
        silent = ImuBoard("AAAA")
        silent.mute = True
        self.bus.plug("1", silent)
        self.bus.plug("2", ImuBoard("BBBB"))
        self.assertEqual(self.run_monitor("--serial", "BBBB", "--seconds", "1.5").returncode, 0)
        run = self.run_monitor("--serial", "AAAA", "--seconds", "1.5")
        self.assertEqual(run.returncode, 1)
        self.assertIn("silent", run.stdout)

    def test_no_board_is_told(self):
        run = self.run_monitor("--seconds", "1.2")
        self.assertEqual(run.returncode, 1)
        self.assertIn("no board there", run.stdout)


class DaemonTest(unittest.TestCase):
    def setUp(self):
        self.bus = Bus()
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.socket = os.path.join(self.folder.name, "slamd.sock")
        path = os.path.join(self.folder.name, "slamd.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'imu:\n  source: "usb"\n  usb_serial: "BBBB"\ngnss:\n  device: ""\n'
                       f'lidar:\n  bind_address: "127.0.0.1"\n  port: 42368\n  position_port: 48308\n'
                       f'server:\n  socket: "{self.socket}"\n  save_dir: "{self.folder.name}"\n')
        self.daemon = subprocess.Popen([os.environ["SLAMD"], "--config", path], env=self.bus.environment,
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(self.end)

    def end(self):
        self.daemon.send_signal(signal.SIGTERM)
        self.log, _ = self.daemon.communicate(timeout=30)

    def imu(self):
        with socket.socket(socket.AF_UNIX) as client:
            client.connect(self.socket)
            client.sendall(b'{"jsonrpc": "2.0", "id": 1, "method": "get_status"}\n')
            with client.makefile() as lines:
                for line in lines:
                    answer = json.loads(line)
                    if answer.get("id") == 1:
                        return answer["result"]["health"]["sources"]["imu"]
        return None

    def wait_for(self, holds, seconds=30):
        imu = None
        for _ in range(seconds * 10):
            try:
                imu = self.imu()
                if holds(imu):
                    return imu
            except (FileNotFoundError, ConnectionRefusedError):
                pass
            time.sleep(0.1)
        self.fail(f"not reached: {imu}")

    def test_the_daemon_follows_unplug_replug_and_reset_of_the_board(self):
        self.bus.plug("1", ImuBoard("AAAA"))  # not this one
        self.wait_for(lambda imu: imu["state"] == "absent")
        self.bus.plug("2", ImuBoard("BBBB"))
        imu = self.wait_for(lambda imu: imu["state"] == "healthy" and imu["received"] > 400)
        self.assertEqual(imu["device"], "usb:1209:0001:BBBB")
        self.assertGreater(imu["clock"]["skew_sigma_ppm"], 0.0)
        self.assertLess(abs(imu["clock"]["skew_ppm"]), 1000.0)  # its truth is clock_sync_test's: this bus jitters
        self.assertEqual(imu["events"]["resets"], 0)

        self.bus.unplug("2")
        self.wait_for(lambda imu: imu["state"] == "absent" and imu["events"]["unplugged"] == 1)
        received = self.imu()["received"]
        self.bus.plug("5", ImuBoard("BBBB"))  # another port, a new clock
        imu = self.wait_for(lambda imu: imu["state"] == "healthy" and imu["received"] > received + 200)
        self.assertEqual(imu["events"]["resets"], 1)


if __name__ == "__main__":
    unittest.main()
