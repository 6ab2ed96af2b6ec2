"""imu-monitor on a pty: live lines, recording, and the Allan evaluation of a file. IMU_MONITOR names the program."""
import os
import pty
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
import tty
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "usb"))
from imu_frames import frame  # noqa: E402

PROGRAM = os.environ["IMU_MONITOR"]


class PtyBoard:
    """Sends frames into a pty whose other end a link names; can go away and come back under the same name."""

    def __init__(self, link):
        self.link = link
        self.stop = threading.Event()

    def plug(self):
        self.stop.clear()
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        if os.path.lexists(self.link):
            os.unlink(self.link)
        os.symlink(os.ttyname(slave), self.link)
        os.close(slave)
        os.set_blocking(self.master, False)
        self.thread = threading.Thread(target=self.send, daemon=True)
        self.thread.start()

    def send(self):
        start, sequence = time.monotonic(), 0
        while not self.stop.is_set():
            while sequence < (time.monotonic() - start) * 208:
                try:
                    os.write(self.master, frame(sequence, int(sequence * 1e6 / 208)))
                except OSError:
                    pass  # nobody reads
                sequence += 1
            time.sleep(0.002)

    def unplug(self):
        self.stop.set()
        self.thread.join()
        os.close(self.master)


class MonitorTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_it_follows_unplug_and_replug_by_the_stable_name_and_records(self):
        board = PtyBoard(self.path("imu"))
        board.plug()
        with subprocess.Popen([PROGRAM, self.path("imu"), "--seconds", "5", "--record", self.path("imu.csv")],
                              stdout=subprocess.PIPE, text=True) as monitor:
            time.sleep(1.5)
            board.unplug()
            time.sleep(0.5)
            board.plug()
            output = monitor.communicate(timeout=60)[0]
        board.unplug()
        self.assertEqual(monitor.returncode, 0, output)
        self.assertRegex(output.splitlines()[-1], r"20\d\.\d Hz .*resets 1 .*\|g\| 9\.80\d\d")
        self.assertRegex(output, r"skew [+-][\d.]+ \+- [\d.]+ ppm")
        with open(self.path("imu.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(lines[0], "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c")
        self.assertGreater(len(lines), 500)

    def test_allan_prints_the_figures_of_known_noise_and_draws(self):
        generator = random.Random(1)
        rate, gyro, accel = 200.0, 1.5e-4, 2e-3
        with open(self.path("rest.csv"), "w", encoding="utf-8") as file:
            for i in range(40_000):
                g = [generator.gauss(0, gyro * rate ** 0.5) for _ in range(3)]
                a = [generator.gauss(0, accel * rate ** 0.5) for _ in range(3)]
                a[2] += 9.81
                file.write(",".join(map(repr, [10**9 + i * 5_000_000, *g, *a, 25.0])) + "\n")
        run = subprocess.run([PROGRAM, "--allan", self.path("rest.csv"), "--plot", self.path("allan.png")],
                             capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        for key, density in (("gyro_noise_rads_rthz", gyro), ("accel_noise_mps2_rthz", accel)):
            value = float(re.search(key + r": (\S+)", run.stdout).group(1))
            self.assertAlmostEqual(value / density, 1.0, delta=0.05)
        with open(self.path("allan.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_wrong_files_are_refused(self):
        self.assertEqual(subprocess.run([PROGRAM, "--allan", self.path("none")], capture_output=True, check=False).returncode, 2)
        with open(self.path("short.csv"), "w", encoding="utf-8") as file:
            file.write("1,0,0,0,0,0,9.81,25\n")
        run = subprocess.run([PROGRAM, "--allan", self.path("short.csv")], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2)
        self.assertIn("has 1 samples", run.stderr)


if __name__ == "__main__":
    unittest.main()
