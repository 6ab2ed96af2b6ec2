"""What slamd records replays to the same poses, bit for bit, also over lost packets, damaged bytes and silent sensors."""

import json
import os
import subprocess
import time
import unittest

from harness import ATTEMPTS, EndToEndTest
from frozen_thread import FrozenThread  # harness knows where


def live_pose(row):
    """A row of get_trajectory: stamp, then the numbers themselves."""
    return row[0], tuple(map(float, row[1:]))


def replayed_poses(path):
    with open(path, encoding="ascii") as file:
        for line in file:
            stamp, *numbers = line.split()
            seconds, nanoseconds = stamp.split(".")
            yield int(seconds) * 1_000_000_000 + int(nanoseconds), tuple(map(float, numbers))


class Record(EndToEndTest):
    def thread(self, daemon, name):
        folder = f"/proc/{daemon.child.pid}/task"
        for task in os.listdir(folder):
            with open(f"{folder}/{task}/comm", encoding="ascii") as comm:
                if comm.read().strip() == name:
                    return int(task)
        return self.fail(f"no thread {name}")

    def hold_up(self, daemon, length_s):
        """Takes the estimator's thread its processor."""
        with FrozenThread(self.thread(daemon, "slamd-estimator")):
            time.sleep(length_s)

    def test_an_estimator_that_was_held_up_catches_up_at_once_and_its_recording_replays(self):
        for attempt in range(ATTEMPTS):
            folder = self.path(f"late-{attempt}")
            daemon = self.start_daemon("--record", folder, "--set", "estimator.hold_back_s=0.1", "--set", "log.repeat_period_s=0.1")
            drive = self.start_simulator("--scenario", "parking", "--rest", "3", "--duration", "16")
            self.await_pose("tracking", lambda pose: pose["status"] == "TRACKING" and pose["T_odom_base"]["translation_m"][0] > 1.0)
            for length_s in (0.45, 0.25):
                self.hold_up(daemon, length_s)
                time.sleep(1.0)
            self.await_value("the end of the drive", lambda: not drive.running(), 180.0)
            poses = dict(map(live_pose, self.client.call("get_trajectory")["result"]["poses"]))
            health = self.client.status()["health"]
            self.client.close()
            self.assert_stops_cleanly(daemon)
            if health["counts"]["late_events"] == 0 and not any(ring["dropped"] for ring in health["rings"].values()):
                break
        else:
            self.skipTest(f"the machine was too busy for every event to be in time: {health['counts']}")
        counts = health["counts"]
        print(f"let go {counts['scans_let_go']}, thinned {counts['scans_thinned']} of {counts['scans']} scans", flush=True)
        self.assertGreaterEqual(counts["scans_let_go"], 2)
        self.assertIn("ring_scans state=dropping", daemon.output())
        replayed, report = self.replay(folder)
        self.assertEqual(report["drops"]["scans_let_go"], counts["scans_let_go"])
        self.assertEqual(report["drops"]["scans_thinned"], counts["scans_thinned"])
        common = [stamp for stamp in replayed if stamp <= max(poses)]
        self.assertGreater(len(common), 30)
        self.assertEqual([stamp for stamp in common if poses.get(stamp) != replayed[stamp]], [])

    def drive_and_record(self, folder):
        """The poses of a live drive, and whether every event was in time: late or dropped ones prove nothing about the order."""
        daemon = self.start_daemon("--record", folder, "--set", "estimator.hold_back_s=0.1")
        drive = self.start_simulator("--scenario", "parking", "--rest", "3", "--duration", "32",
                                     "--fault", "lidar:loss=0.02", "--fault", "imu:corrupt=1e-3",
                                     "--fault", "lidar:gap@12+1.5", "--fault", "imu:gap@20+1")
        self.await_value("the end of the drive", lambda: not drive.running(), 180.0)
        poses = dict(map(live_pose, self.client.call("get_trajectory")["result"]["poses"]))
        health = self.client.status()["health"]
        self.client.close()
        self.assert_stops_cleanly(daemon)
        drops = {name: ring["dropped"] for name, ring in health["rings"].items() if ring["dropped"]}
        return poses, health["counts"]["late_events"] == 0 and not drops, (health["counts"], drops)

    def replay(self, folder):
        out = os.path.join(folder, "replayed")
        subprocess.run([os.environ["SLAM_REPLAY"], folder, "--out", out, "--quiet", "--no-map"], check=True, timeout=300)
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            return dict(replayed_poses(os.path.join(out, "odom.tum"))), json.load(file)

    def test_a_recording_replays_to_the_poses_of_the_live_drive(self):
        for attempt in range(ATTEMPTS):
            folder = self.path(f"recording-{attempt}")
            live, in_time, counts = self.drive_and_record(folder)
            replayed, report = self.replay(folder)
            if in_time:
                break
        else:
            self.skipTest(f"the machine was too busy for every event to be in time: {counts}")
        common = [stamp for stamp in replayed if stamp <= max(live)]
        self.assertGreater(len(common), 30)  # a busy machine sends late, and the drive ends before its time
        different = [stamp for stamp in common if live.get(stamp) != replayed[stamp]]
        self.assertEqual(different, [], f"first at {common.index(different[0]) if different else 0} of {len(common)}")
        self.assertGreater(report["rejections"]["imu"]["crc"], 10)
        self.assertIn("no_imu", json.dumps(report["status"]))
        self.assertIn("no_lidar", json.dumps(report["status"]))

    def test_a_recording_is_never_written_over(self):
        folder = self.path("recording")
        self.assert_stops_cleanly(self.start_daemon("--record", folder))
        again = self.start("slamd", [*self.daemon_arguments(), "--record", folder])
        self.assertEqual(again.wait(60.0), 1)
        self.assertIn("recording", again.output())


if __name__ == "__main__":
    unittest.main()
