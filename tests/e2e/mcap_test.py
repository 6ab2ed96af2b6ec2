"""What slamd records as MCAP: other people's libraries decode every message of every channel, a replay has the same bits as that of the
drive folder of the same drive, a crash and a limit leave a file that is read, and names lead nowhere else."""

import filecmp
import json
import math
import os
import signal
import subprocess
import time
import unittest

from harness import EndToEndTest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DECODE = os.path.join(ROOT, "tests/recording/decode.mjs")
TYPES = {"/points": "sensor_msgs/msg/PointCloud2", "/imu": "sensor_msgs/msg/Imu", "/fix": "sensor_msgs/msg/NavSatFix",
         "/odom": "nav_msgs/msg/Odometry", "/tf": "tf2_msgs/msg/TFMessage", "/tf_static": "tf2_msgs/msg/TFMessage",
         "/slamd/raw/lidar": "slamd_msgs/msg/RawRead", "/slamd/raw/imu": "slamd_msgs/msg/RawRead",
         "/slamd/raw/gps": "slamd_msgs/msg/RawRead", "/slamd/raw/wheel": "slamd_msgs/msg/RawRead", "/slamd/scan_share": "slamd_msgs/msg/ScanShare"}
DRIVE = ["--scenario", "campus", "--rest", "3"]  # with GPS


def places(folder):
    with open(os.path.join(folder, "odom.tum"), encoding="ascii") as file:
        return [[float(word) for word in line.split()[:4]] for line in file]


class Mcap(EndToEndTest):
    def start_recorder(self, *extra):
        return self.start_daemon("--set", f"recording.folder={self.path('recordings')}", *extra)

    def record(self, name, **limits):
        answer = self.client.call("start_recording", name=name, **limits)
        self.assertIn("result", answer, answer)
        self.assertEqual(answer["result"]["path"], os.path.join(self.path("recordings"), name))
        return answer["result"]["path"]

    def refusal(self, method, **params):
        return self.client.call(method, **params)["error"]["code"]

    def decode(self, path, *mode):
        run = subprocess.run([os.environ["SLAMD_NODE"], DECODE, path, *mode], capture_output=True, text=True, check=False, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def replay(self, drive, name, *options):
        out = self.path(name)
        run = subprocess.run([os.environ["SLAM_REPLAY"], drive, "--out", out, "--quiet", "--no-map", *options], capture_output=True, text=True,
                             check=False, timeout=300)
        self.assertEqual(run.returncode, 0, run.stderr)
        return out, run.stderr

    def state(self):
        return self.client.status()["health"]["recording"]

    def assert_values_make_sense(self, topics, seconds):
        self.assertEqual({topic: about["type"] for topic, about in topics.items()}, TYPES)
        for topic, about in topics.items():
            self.assertEqual(about["encoding"], "ros2msg", topic)
            if topic not in ("/slamd/scan_share", "/slamd/raw/wheel"):
                self.assertGreater(about["messages"], 0, topic)
        self.assertGreater(topics["/points"]["messages"], 8 * seconds)
        cloud = topics["/points"]["last"]
        self.assertEqual([field["name"] for field in cloud["fields"]], ["x", "y", "z", "intensity", "ring", "time"])
        self.assertEqual(cloud["data"]["length"], cloud["width"] * cloud["point_step"])
        self.assertGreater(cloud["width"], 5000)
        norm = sum(topics["/imu"]["first"]["linear_acceleration"][axis] ** 2 for axis in "xyz") ** 0.5
        self.assertAlmostEqual(norm, 9.81, delta=0.3)
        self.assertTrue(all(a <= b for a, b in zip(topics["/imu"]["stamps"], topics["/imu"]["stamps"][1:])))
        self.assertAlmostEqual(topics["/imu"]["stamps"][-1], time.time(), delta=600)
        frames = {(t["header"]["frame_id"], t["child_frame_id"]) for topic in ("/tf", "/tf_static") for t in topics[topic]["last"]["transforms"]}
        self.assertEqual(frames, {("map", "odom"), ("odom", "base_link"), ("base_link", "lidar"), ("base_link", "imu"), ("base_link", "gps")})
        self.assertEqual(topics["/odom"]["last"]["child_frame_id"], "base_link")

    def test_a_recording_is_decoded_by_others_and_replays_as_the_drive_folder_does(self):
        folder = self.path("folder")
        daemon = self.start_recorder("--record", folder)
        path = self.record("live.mcap")
        self.assertEqual(self.state()["state"], "recording")
        drive = self.start_simulator(*DRIVE, "--duration", "16")
        self.await_value("the end of the drive", lambda: not drive.running(), 180.0)
        stopped = self.client.call("stop_recording")["result"]
        self.assertEqual(self.state()["state"], "finished")
        self.assertEqual(stopped["bytes"], os.path.getsize(path))
        self.client.close()
        self.assert_stops_cleanly(daemon)

        found = self.decode(path)
        self.assertEqual(found["statistics"], stopped["messages"])
        self.assertEqual(found["statistics"], sum(topic["messages"] for topic in found["topics"].values()))
        self.assertEqual(found["profile"], "ros2")
        self.assertEqual([name for name, _ in found["attachments"]], ["slamd.yaml"])
        self.assert_values_make_sense(found["topics"], 15)

        by_folder, _ = self.replay(folder, "by-folder")
        by_mcap, _ = self.replay(path, "by-mcap")
        self.assertGreater(os.path.getsize(os.path.join(by_mcap, "odom.tum")), 5000)
        for name in ("odom.tum", "imu_rate.tum", "covariance.csv", "keyframes.csv"):
            self.assertTrue(filecmp.cmp(os.path.join(by_folder, name), os.path.join(by_mcap, name), shallow=False), name)

        by_values, _ = self.replay(path, "by-values", "--topic", "lidar=/points", "--topic", "imu=/imu")
        to_utc_s = int(dict(found["metadata"])["slamd"]["host_to_utc_ns"]) * 1e-9
        end = places(by_values)[-1]
        same = min(places(by_mcap), key=lambda place: abs(place[0] + to_utc_s - end[0]))
        self.assertLess(abs(same[0] + to_utc_s - end[0]), 0.02, "a scan of both")
        self.assertGreater(math.dist(end[1:], (0, 0, 0)), 5.0, "it drove")
        self.assertLess(math.dist(end[1:], same[1:]), 0.2, "clouds and samples say the same")

    def test_a_crash_and_a_limit_leave_files_that_are_read(self):
        daemon = self.start_recorder()
        drive = self.start_simulator(*DRIVE, "--duration", "60")
        self.await_value("packets", lambda: self.client.status()["health"]["sources"]["lidar"]["received"] > 1000, 60.0)
        short = self.record("short.mcap", max_s=1.5)
        self.await_value("the limit", lambda: self.state()["state"] == "finished", 60.0)
        self.assertEqual(self.state()["reason"], "max_s reached")
        self.assertGreater(self.decode(short)["statistics"], 100)
        crashed = self.record("crashed.mcap")
        self.await_value("five seconds", lambda: self.state()["seconds"] > 5.0, 60.0)
        daemon.send(signal.SIGKILL)
        daemon.wait(10.0)
        drive.stop()
        self.client.close()
        self.client = None
        found = self.decode(crashed, "--stream")
        self.assertFalse(found["done"], "nobody closed it")
        self.assertGreater(found["topics"]["/slamd/raw/lidar"]["messages"], 2000)
        out, _ = self.replay(crashed, "by-crashed")
        self.assertGreater(os.path.getsize(os.path.join(out, "odom.tum")), 1000)

    def test_names_lead_nowhere_else_and_one_recording_is_made_at_a_time(self):
        self.start_recorder()
        for name in ("", "x", "../x.mcap", "/tmp/x.mcap", ".x.mcap", "a b.mcap"):
            self.assertEqual(self.refusal("start_recording", name=name), -32002, name)
        self.assertEqual(self.refusal("stop_recording"), -32003)
        self.record("one.mcap")
        self.assertEqual(self.refusal("start_recording", name="two.mcap"), -32003)
        self.assertIn("result", self.client.call("stop_recording"))
        self.assertEqual(self.refusal("start_recording", name="one.mcap"), -32003, "never written over")


if __name__ == "__main__":
    unittest.main()
