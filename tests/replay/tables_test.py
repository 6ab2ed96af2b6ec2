"""slam-eval tables: one command makes a drive, runs it in every configuration and leaves tables, JSON and a picture; the drive
is used again. SLAM_EVAL, SLAM_SIM and SLAM_REPLAY are paths."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

CONFIGURATIONS = ["front-end", "loops", "gps", "both"]


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory(prefix="slamd-tables-")
        cls.out = pathlib.Path(cls.temp.name)
        cls.first = cls.run_tables("--scenario", "campus", "--seeds", "1", "--length", "100")

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    @classmethod
    def run_tables(cls, *options):
        command = [os.environ["SLAM_EVAL"], "tables", "--out", str(cls.out), "--slam-sim", os.environ["SLAM_SIM"],
                   "--slam-replay", os.environ["SLAM_REPLAY"], "--jobs", "2", *options]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=400)

    def tables(self):
        return json.loads((self.out / "tables.json").read_text(encoding="utf-8"))

    def test_every_configuration_is_run_and_evaluated(self):
        self.assertEqual(self.first.returncode, 0, self.first.stderr)
        runs = self.tables()["runs"]
        self.assertEqual([run["configuration"] for run in runs], CONFIGURATIONS)
        for run in runs:
            self.assertAlmostEqual(run["driven_m"], 100.0, delta=3.0)
            self.assertLess(run["ape_m"]["rmse"], 0.05, run)
            self.assertGreater(run["rpe_m"]["rmse"], 0.0, run)

    def test_ratios_are_to_the_front_end_of_the_same_drive(self):
        tables = self.tables()
        front_end = tables["runs"][0]["ape_m"]["rmse"]
        for run, summary in zip(tables["runs"], tables["summary"]):
            self.assertAlmostEqual(summary["ape_ratio"]["median"], run["ape_m"]["rmse"] / front_end)

    def test_the_papers_table_stands_beside_ours(self):
        text = (self.out / "tables.md").read_text(encoding="utf-8")
        self.assertEqual(text, self.first.stdout)
        self.assertIn("| Velodyne | + GTSAM PGO | 0.460 | 0.276 | 0.75 | 1.79 |", text)
        self.assertIn("| campus, 10", text)
        self.assertEqual((self.out / "campus-1-100m.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_a_bad_seed_or_a_failing_program_is_told(self):
        bad = self.run_tables("--seeds", "3-1")
        self.assertEqual(bad.returncode, 1)
        self.assertIn("--seeds 3-1", bad.stderr)
        failed = self.run_tables("--scenario", "no-such-place", "--seeds", "1")
        self.assertEqual(failed.returncode, 1)
        self.assertIn("no-such-place", failed.stderr)


class PaperTables(unittest.TestCase):
    """Every drive of the paper's tables, cut to a few metres: what is there, not how good it is."""

    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory(prefix="slamd-paper-") as folder:
            command = [os.environ["SLAM_EVAL"], "tables", "--out", folder, "--slam-sim", os.environ["SLAM_SIM"],
                       "--slam-replay", os.environ["SLAM_REPLAY"], "--jobs", "2", "--length", "25"]
            cls.done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=400)
            out = pathlib.Path(folder)
            cls.tables = json.loads((out / "tables.json").read_text(encoding="utf-8"))["tables"] if cls.done.returncode == 0 else []
            cls.pictures = {path.name: path.read_bytes()[:8] for path in out.glob("*.png")}

    def test_every_row_has_its_run(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.assertGreaterEqual(len(self.tables), 5)
        for table in self.tables:
            for row in table["rows"]:
                self.assertEqual(len(row["runs"]), 1, (table["title"], row["label"]))
                self.assertLess(row["runs"][0]["ape_m"]["rmse"], 1.0, row)
                if table["ape_to_gps"]:
                    self.assertGreater(row["runs"][0]["ape_to_gps_m"]["rmse"], 0.0, row)

    def test_the_papers_numbers_stand_beside_ours(self):
        for line in ("| C1: TurtleBot3, LDS-01 | 0.011 | 0.012 |", "| RPLidar A2 | 0.203 | 0.067 |",
                     "| paper: APE | 0.580 | 0.535 | 0.615 | 1.308 |", "| RoboSense Airy, + pose graph | 0.585 | 0.297 |"):
            self.assertIn(line, self.done.stdout)

    def test_there_are_grids_maps_and_pictures_before_and_after(self):
        for name in ("house-1-25m-planar.png", "campus-1-25m-rplidar_a2-wheel-planar.png", "campus-1-25m-vlp16-map.png",
                     "campus-1-25m-airy-before-after.png"):
            self.assertEqual(self.pictures.get(name), b"\x89PNG\r\n\x1a\n", sorted(self.pictures))
            self.assertIn(f"({name})", self.done.stdout)


if __name__ == "__main__":
    unittest.main()
