"""slam-replay on a recorded drive: the same input gives the same files, the errors stay within bounds, and what is missing
or damaged is survived or refused. SLAM_REPLAY, SLAM_EVAL and SLAMD_SHARED_DATA come from ctest."""
import json
import os
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DRIVE = os.path.join(os.environ["SLAMD_SHARED_DATA"], "drive_sample")
CONFIG = os.path.join(ROOT, "config/slamd.yaml")
OUTPUTS = ("odom.tum", "imu_rate.tum", "map.pcd")
MAX_APE_RMSE_M = 0.015
MAX_RPE_RMSE_M = 0.015  # over 1 m


def read(path):
    with open(path, "rb") as file:
        return file.read()


def rows(path):
    with open(path, encoding="utf-8") as file:
        return [[float(word) for word in line.split()] for line in file if not line.startswith("#")]


@unittest.skipUnless(os.path.isdir(DRIVE), "shared data is absent: " + DRIVE)
class Replay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.first = cls.replay(DRIVE, "first")
        cls.second = cls.replay(DRIVE, "second")

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    @classmethod
    def try_replay(cls, drive, name, *options):
        out = os.path.join(cls.temp.name, name)
        run = subprocess.run([os.environ["SLAM_REPLAY"], drive, "--config", CONFIG, "--out", out, *options],
                             capture_output=True, text=True, check=False, timeout=300)
        return run, out

    @classmethod
    def replay(cls, drive, name, *options):
        run, out = cls.try_replay(drive, name, *options)
        if run.returncode != 0:
            raise AssertionError(f"slam-replay ended with {run.returncode}: {run.stderr}")
        return out

    def report(self, out):
        return json.loads(read(os.path.join(out, "report.json")))

    def evaluate(self, out, *command):
        result = os.path.join(self.temp.name, "eval.json")
        subprocess.run([os.environ["SLAM_EVAL"], *command, os.path.join(DRIVE, "truth.tum"), os.path.join(out, "odom.tum"),
                        "--json", result], check=True, stdout=subprocess.DEVNULL)
        return json.loads(read(result))

    def copy_without(self, *names):
        drive = tempfile.mkdtemp(dir=self.temp.name)
        for name in os.listdir(DRIVE):
            if name not in names:
                os.symlink(os.path.join(DRIVE, name), os.path.join(drive, name))
        return drive

    def test_two_runs_give_identical_files(self):
        for name in OUTPUTS:
            self.assertGreater(os.path.getsize(os.path.join(self.first, name)), 1000, name)
            self.assertEqual(read(os.path.join(self.first, name)), read(os.path.join(self.second, name)), name)

    def test_odom_has_one_pose_a_scan_and_stamps_that_rise(self):
        poses = rows(os.path.join(self.first, "odom.tum"))
        self.assertEqual(len(poses), self.report(self.first)["scans"])
        self.assertGreater(len(poses), 220)
        stamps = [pose[0] for pose in poses]
        self.assertTrue(all(a < b for a, b in zip(stamps, stamps[1:])))

    def test_imu_rate_trajectory_is_dense_and_joins_the_scans(self):
        poses = rows(os.path.join(self.first, "imu_rate.tum"))
        span_s = poses[-1][0] - poses[0][0]
        self.assertGreater(len(poses) / span_s, 150)
        self.assertGreater(span_s, 20)

    def test_errors_against_the_truth_are_small(self):
        ape = self.evaluate(self.first, "ape")
        self.assertGreater(ape["matched_poses"], 200)
        self.assertLess(ape["results"]["translation_part"]["rmse"], MAX_APE_RMSE_M)
        rpe = self.evaluate(self.first, "rpe", "-d", "1", "-u", "m")
        self.assertLess(rpe["results"]["translation_part"]["rmse"], MAX_RPE_RMSE_M)

    def test_report_has_what_is_promised(self):
        report = self.report(self.first)
        for key in ("scans", "duration_s", "realtime_factor", "peak_rss_mb", "scan_ms", "drops", "rejections", "status"):
            self.assertIn(key, report)
        for key in ("p50", "p90", "p99", "p999", "max"):
            self.assertGreater(report["scan_ms"][key], 0.0)
        self.assertGreater(report["realtime_factor"], 1.0)

    def test_switches_for_the_back_end_are_accepted(self):
        out = self.replay(DRIVE, "switches", "--no-loops", "--no-gps")
        self.assertEqual(read(os.path.join(out, "odom.tum")), read(os.path.join(self.first, "odom.tum")))

    def test_a_drive_without_gps_gives_the_same_odometry(self):
        out = self.replay(self.copy_without("gps.csv"), "no_gps")
        self.assertEqual(read(os.path.join(out, "odom.tum")), read(os.path.join(self.first, "odom.tum")))

    def test_a_drive_without_imu_runs_and_says_so(self):
        out = self.replay(self.copy_without("imu.csv"), "no_imu")
        self.assertGreater(len(rows(os.path.join(out, "odom.tum"))), 150)
        self.assertIn("no_imu", json.dumps(self.report(out)["status"]))

    def test_a_cut_recording_gives_its_whole_packets(self):
        drive = self.copy_without("lidar.pcap")
        whole = read(os.path.join(DRIVE, "lidar.pcap"))
        with open(os.path.join(drive, "lidar.pcap"), "wb") as file:
            file.write(whole[:len(whole) // 2 + 77])
        scans = self.report(self.replay(drive, "cut"))["scans"]
        self.assertGreater(scans, 100)
        self.assertLess(scans, self.report(self.first)["scans"])

    def test_what_is_no_drive_is_refused_with_a_reason(self):
        empty = tempfile.mkdtemp(dir=self.temp.name)
        for drive in ("/nonexistent", empty):
            run, _ = self.try_replay(drive, "refused")
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(drive, run.stderr)

    def test_an_unknown_key_of_the_configuration_is_refused_with_its_line(self):
        config = os.path.join(self.temp.name, "bad.yaml")
        with open(config, "w", encoding="utf-8") as file:
            file.write("imu:\n  colour: red\n")
        run = subprocess.run([os.environ["SLAM_REPLAY"], DRIVE, "--config", config, "--out", self.temp.name + "/bad"],
                             capture_output=True, text=True, check=False, timeout=60)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("bad.yaml:2", run.stderr)


if __name__ == "__main__":
    unittest.main()
