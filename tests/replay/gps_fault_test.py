"""One simulated drive with eight receivers, each failing in its own way from 20 s on: the map is that of the drive without
GPS, what is wrong is refused, and the place on the earth stays. SLAM_SIM and SLAM_REPLAY come from ctest."""

import json
import os
import subprocess
import tempfile
import unittest

from rigid import Truth

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DRIVE = ("--scenario", "campus", "--seed", "4", "--rest", "2", "--duration", "36", "--gps-rate", "5")
BEGIN_S = 1020.0   # host time of the faults
TIE_S = 1.0        # fixes just before may be judged with what came after
SAME_MAP_M = 0.002
PLACE_M = 4.0      # four sigma of an error that lasts for a minute
ACCEPTED = 0       # FixVerdict of estimator/graph/gnss_position.hpp

# What is wrong, and how many of its 80 fixes may be believed at most.
RECEIVERS = {
    "off": (("gps:off@20",), 0),
    "stuck": (("gps:stuck@20",), 5),
    "garbage": (("gps:corrupt=0.02@20",), 60),
    "wrong": (("gps:jump=30@20",), 0),
    "wrong for a while": (("gps:jump=30@20+3",), 65),
    "slow": (tuple(f"gps:gap@{20.1 + 2 * k:g}+1.8" for k in range(8)), 20),
    "delayed": (("gps:late=2@20",), 80),
    "intermittent": (tuple(f"gps:jump=30@{20 + 2 * k}+1" for k in range(8)), 40),
}


def run(program, *arguments):
    subprocess.run([os.environ[program], *arguments, "--quiet"], check=True, timeout=300)


class GpsFaults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        run("SLAM_SIM", *DRIVE, "--out", cls.path("drive"))
        cls.without = cls.replay("drive", "--no-gps")
        cls.good = cls.replay("drive")

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.temp.name, *names)

    @classmethod
    def replay(cls, drive, *options):
        out = cls.path(drive + "-out" + "".join(options))
        run("SLAM_REPLAY", cls.path(drive), "--config", os.path.join(ROOT, "config/slamd.yaml"), "--out", out, *options)
        return out

    def drive_with(self, receiver, faults):
        """The same drive, heard by another receiver."""
        options = [word for fault in faults for word in ("--fault", fault)]
        run("SLAM_SIM", *DRIVE, "--no-lidar", "--no-imu", *options, "--out", self.path(receiver))
        for name in ("lidar.pcap", "imu.csv"):
            os.symlink(self.path("drive", name), self.path(receiver, name))
        return self.replay(receiver)

    def worst_difference_m(self, out):
        with_gps, without = (Truth(os.path.join(folder, "map.tum")) for folder in (out, self.without))
        self.assertEqual(with_gps.stamps, without.stamps)
        return max(abs(a - b) for p, q in zip(with_gps.poses, without.poses) for a, b in zip(p[0], q[0]))

    def believed(self, out):
        with open(os.path.join(out, "gps.csv"), encoding="ascii") as file:
            rows = [line.split(",") for line in file][1:]
        return sum(int(row[0]) * 1e-9 > BEGIN_S + TIE_S and int(row[1]) == ACCEPTED for row in rows)

    def shift(self, out):
        """Of the map from the first fix, which comes before any fault."""
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            return json.load(file)["gps"]["translation_m"]

    def test_a_good_receiver_finds_the_place_and_leaves_the_map_alone(self):
        self.assertLess(self.worst_difference_m(self.good), SAME_MAP_M)
        self.assertGreater(self.believed(self.good), 60)

    def test_no_fault_bends_the_map_or_moves_its_place(self):
        good = self.shift(self.good)
        for receiver, (faults, most_believed) in RECEIVERS.items():
            with self.subTest(receiver):
                out = self.drive_with(receiver.replace(" ", "-"), faults)
                self.assertLess(self.worst_difference_m(out), SAME_MAP_M)
                self.assertLessEqual(self.believed(out), most_believed)
                self.assertLess(max(abs(a - b) for a, b in zip(self.shift(out)[:2], good[:2])), PLACE_M)


if __name__ == "__main__":
    unittest.main()
