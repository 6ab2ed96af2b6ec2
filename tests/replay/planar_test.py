"""Planar SLAM on the real log of Intel's laboratory: as exact as the published figures, and the same bytes twice. SLAM_REPLAY is a
path; without the shared data it is skipped. Takes some 15 s of one core."""

import math
import os
import pathlib
import subprocess
import tempfile
import unittest

LOG_FOLDER = pathlib.Path(os.environ["SLAMD_SHARED_DATA"]) / "carmen/intel"
CARTOGRAPHER_M = 0.023  # mean over all relations of the full log, published 2016
ALL_STAMPS_M = 0.045    # relations whose stamps are known to 5 ms only: mostly the recording's own error


def poses(path):
    found = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        words = [float(word) for word in line.split()]
        found[words[0]] = (words[1], words[2], 2.0 * math.atan2(words[6], words[7]))
    return found


def mean_error(relations, trajectory):
    stamps = sorted(trajectory)
    near = {round(stamp, 4): stamp for stamp in stamps}
    errors = []
    for line in relations.read_text(encoding="utf-8").splitlines():
        words = [float(word) for word in line.split()]
        ends = [near.get(round(t, 4)) or min(stamps, key=lambda stamp, t=t: abs(stamp - t)) for t in words[:2]]
        (ax, ay, a), (bx, by, _) = (trajectory[end] for end in ends)
        dx, dy = bx - ax, by - ay
        along, across = math.cos(a) * dx + math.sin(a) * dy, -math.sin(a) * dx + math.cos(a) * dy
        errors.append(math.hypot(along - words[2], across - words[3]))
    return sum(errors) / len(errors)


@unittest.skipUnless(LOG_FOLDER.exists(), f"{LOG_FOLDER} is not there")
class Intel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory(prefix="slamd-planar-")
        cls.folders = [pathlib.Path(cls.temp.name) / name for name in ("a", "b")]
        for folder in cls.folders:
            subprocess.run([os.environ["SLAM_REPLAY"], str(LOG_FOLDER / "intel_rebuilt.clf.gz"), "--out", str(folder), "--quiet"],
                           check=True, timeout=400)

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    def test_relations_are_as_exact_as_the_published_figures(self):
        trajectory = poses(self.folders[0] / "wheel_rate.tum")
        self.assertLess(mean_error(LOG_FOLDER / "intel_exact.relations", trajectory), CARTOGRAPHER_M)
        self.assertLess(mean_error(LOG_FOLDER / "intel_first1088s.relations", trajectory), CARTOGRAPHER_M)
        self.assertLess(mean_error(LOG_FOLDER / "intel.relations", trajectory), ALL_STAMPS_M)

    def test_two_runs_give_the_same_bytes(self):
        for name in ("odom.tum", "map.tum", "wheel_rate.tum", "map.pgm", "map.yaml"):
            a, b = ((folder / name).read_bytes() for folder in self.folders)
            self.assertTrue(a == b, name)

    def test_the_map_is_one_that_map_server_reads(self):
        yaml = (self.folders[0] / "map.yaml").read_text(encoding="utf-8")
        for line in ("image: map.pgm", "mode: trinary", "resolution: 0.05", "negate: 0", "occupied_thresh: 0.65", "free_thresh: 0.196"):
            self.assertIn(line + "\n", yaml)
        picture = (self.folders[0] / "map.pgm").read_bytes()
        _, size, _, cells = picture.split(b"\n", 3)
        width, height = map(int, size.split())
        self.assertEqual(len(cells), width * height)
        self.assertEqual(set(cells), {0, 205, 254})


if __name__ == "__main__":
    unittest.main()
