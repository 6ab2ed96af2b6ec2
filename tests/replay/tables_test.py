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


if __name__ == "__main__":
    unittest.main()
