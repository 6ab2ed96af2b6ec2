"""LOST is left into the same map: sensors fail for half a minute while the vehicle drives on, and come back where it has been
before. One drive by slam-sim and slam-replay, which come from ctest as SLAM_SIM and SLAM_REPLAY."""

import filecmp
import json
import math
import os
import subprocess
import tempfile
import unittest

from fault_drives import HOST_START_S, Alignment, read_poses
from rigid import Truth

BACK_S = 95.0  # the sensors are back: on the second lap of the parking house
FAULTS = ("lidar:gap@55+40", "imu:gap@65+30")


def run(*command):
    subprocess.run(command, check=True, timeout=600)


class Relocalise(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="slamd-relocalise-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.drive = os.path.join(cls.folder.name, "drive")
        faults = [word for fault in FAULTS for word in ("--fault", fault)]
        run(os.environ["SLAM_SIM"], "--scenario", "parking", "--seed", "1", "--out", cls.drive, "--quiet", *faults)
        cls.first, cls.second = (cls.replay(name) for name in ("first", "second"))
        with open(os.path.join(cls.first, "report.json"), encoding="utf-8") as file:
            cls.report = json.load(file)
        cls.status = [(entry["t_s"] - HOST_START_S, entry["status"], set(entry["reasons"])) for entry in cls.report["status"]]

    @classmethod
    def replay(cls, name):
        out = os.path.join(cls.folder.name, name)
        run(os.environ["SLAM_REPLAY"], cls.drive, "--out", out, "--quiet")
        return out

    def test_it_is_lost_meanwhile_and_never_tracks_before_it_is_found(self):
        self.assertIn("LOST", {status for t, status, _ in self.status if t < BACK_S})
        found_s = self.found_s()
        meanwhile = [(status, reasons) for t, status, reasons in self.status if BACK_S + 0.2 < t < found_s]
        self.assertTrue(meanwhile)
        for status, reasons in meanwhile:
            self.assertNotEqual(status, "TRACKING")
            self.assertIn("relocalising", reasons)

    def found_s(self):
        return next(t for t, status, reasons in self.status if t > BACK_S and "relocalising" not in reasons and status != "LOST")

    def test_it_tracks_in_the_same_map_within_seconds(self):
        self.assertEqual(self.report["back_end"]["relocalised"], 1)
        self.assertEqual(self.report["back_end"]["maps_begun_anew"], 0)
        self.assertLess(self.found_s() - BACK_S, 20.0)
        print(f"found {self.found_s() - BACK_S:.1f} s after the sensors were back")
        self.assertEqual(self.status[-1][1], "TRACKING")

    def test_its_poses_go_on_in_the_map_of_before(self):
        truth = Truth(os.path.join(self.drive, "truth.tum"))
        poses = list(read_poses(os.path.join(self.first, "map.tum")))
        start = poses[0]
        alignment = Alignment(start[1:], truth.at(HOST_START_S + start[0]))
        errors = [(t, math.dist(p, alignment.position(truth.at(HOST_START_S + t)[0]))) for t, p, _ in poses]
        after = [error for t, error in errors if t > BACK_S]
        self.assertGreater(len(after), 200)
        self.assertLess(max(after), 0.3, "metres, with the tilt that the start has learnt")

    def test_two_replays_are_the_same_to_the_last_bit(self):
        for name in ("odom.tum", "map.tum", "closures.csv", "map.pcd"):
            self.assertTrue(filecmp.cmp(os.path.join(self.first, name), os.path.join(self.second, name), shallow=False), name)


if __name__ == "__main__":
    unittest.main()
