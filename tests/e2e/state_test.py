"""What outlives a crash: kill -9 at rest and back in the same map, elsewhere a new one, damaged files; and what the flight recorder
dumps, replayed."""

import glob
import json
import math
import os
import signal
import subprocess
import time
import unittest

from harness import EndToEndTest, in_real_time


class State(EndToEndTest):
    def start_daemon(self, *extra):
        return super().start_daemon("--set", f"checkpoint.folder={self.path('.')}", "--set", "checkpoint.period_s=1",
                                    "--set", f"flight_recorder.folder={self.path('dumps')}", *extra)

    def back_end(self):
        return self.client.status()["health"]["back_end"]

    def checkpoint(self):
        return self.client.status()["health"]["checkpoint"]

    def start_drive(self, *extra):
        return self.start_simulator("--scenario", "parking", *extra)

    def kill(self, daemon):
        self.client.close()
        daemon.send(signal.SIGKILL)
        daemon.wait(30.0)

    def await_tracking(self, timeout_s=60.0):
        return self.await_pose("TRACKING", lambda pose: pose["status"] == "TRACKING", timeout_s)

    def await_verdict(self):
        """Whether the map of before was found again, or a new one begun; told a moment after the pose."""

        def verdict():
            told = self.back_end()
            return (told["relocalised"], told["maps_begun_anew"])

        return self.await_value("a verdict", lambda: verdict() if sum(verdict()) > 0 else None, 30.0)

    def stand_until_kept(self):
        """The pose in map, once a checkpoint of it is written."""
        self.await_tracking()
        self.await_value("a checkpoint", lambda: self.checkpoint()["written"] > 0, 60.0)
        return self.client.pose()["T_map_base"]

    @in_real_time
    def test_killed_at_rest_it_is_back_in_the_same_map(self):
        daemon = self.start_daemon()
        self.start_drive("--rest", "120", "--duration", "120")
        before = self.stand_until_kept()
        self.kill(daemon)
        begin = time.monotonic()
        daemon = self.start_daemon()
        after = self.await_tracking()["T_map_base"]
        print(f"TRACKING {time.monotonic() - begin:.2f} s after the start", flush=True)
        self.assertLess(math.dist(before["translation_m"], after["translation_m"]), 0.1)
        self.assertEqual(self.await_verdict(), (1, 0))
        self.await_value("the log", lambda: "map state=relocalised" in daemon.output(), 10.0)

    @in_real_time
    def test_killed_while_it_drives_it_tracks_again_in_the_same_map(self):
        daemon = self.start_daemon("--set", "checkpoint.period_s=3600")
        self.start_drive("--rest", "3", "--duration", "150")
        self.await_tracking()
        self.await_value("30 keyframes", lambda: self.back_end()["keyframes"] > 30, 60.0)
        self.kill(daemon)
        begin = time.monotonic()
        daemon = self.start_daemon()
        self.await_tracking(90.0)
        print(f"TRACKING {time.monotonic() - begin:.2f} s after the start", flush=True)
        self.assertEqual(self.await_verdict(), (1, 0))
        self.await_value("the log", lambda: "map state=relocalised" in daemon.output(), 10.0)

    @in_real_time
    def test_in_another_place_a_new_map_begins_and_it_says_so(self):
        daemon = self.start_daemon()
        simulator = self.start_drive("--rest", "120", "--duration", "120")
        self.stand_until_kept()
        self.kill(daemon)
        simulator.send(signal.SIGTERM)
        simulator.wait(30.0)
        daemon = self.start_daemon()
        self.start_simulator("--scenario", "campus", "--rest", "120", "--duration", "120")
        self.await_tracking()
        self.assertEqual(self.await_verdict(), (0, 1))
        self.await_value("the log", lambda: "map state=begun_anew" in daemon.output(), 10.0)

    def test_damaged_checkpoints_are_refused_with_a_reason(self):
        for content in (b"", b"SLAMDMAP", b"SLAMDMAP\x01\0\0\0\0\0\0\0" + bytes(500), os.urandom(5000)):
            with open(self.path("checkpoint.map"), "wb") as file:
                file.write(content)
            daemon = self.start_daemon()
            told = "checkpoint state=refused" if content else "checkpoint state=none"
            self.await_value("the refusal", lambda: told in daemon.output(), 10.0)
            self.client.close()
            self.assert_stops_cleanly(daemon)

    def test_a_folder_that_takes_no_checkpoint_is_said_and_lived_without(self):
        daemon = self.start_daemon("--set", "checkpoint.folder=/proc")
        self.start_drive("--rest", "60", "--duration", "60")
        self.await_tracking()
        self.await_value("the failure", lambda: self.checkpoint()["state"] == "failed", 30.0)
        self.await_value("the log", lambda: "checkpoint state=failed" in daemon.output(), 10.0)

    def replay(self, folder):
        out = os.path.join(folder, "replayed")
        subprocess.run([os.environ["SLAM_REPLAY"], folder, "--out", out, "--quiet", "--no-map"], check=True, timeout=300)
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            return json.load(file)

    def test_a_dump_is_a_drive_that_replays(self):
        self.start_daemon("--set", "flight_recorder.span_s=15")
        self.start_drive("--rest", "3", "--duration", "40")
        self.await_tracking()
        self.await_value("20 m driven", lambda: self.client.pose()["T_odom_base"]["translation_m"][0] > 20.0, 90.0)
        answer = self.client.call("dump", name="fault-1")
        folder = answer["result"]["path"]
        self.assertEqual(folder, self.path("dumps/fault-1"))
        self.assertEqual(sorted(os.listdir(folder)), ["dump.json", "gps.pcap", "imu.pcap", "lidar.pcap", "scan_shares.csv", "slamd.yaml", "wheel.pcap"])
        self.assertIn("error", self.client.call("dump", name="fault-1"), "never written over")
        for name in ("../out", "a/b", ".hidden", "x" * 200):
            self.assertIn("error", self.client.call("dump", name=name), name)
        report = self.replay(folder)
        self.assertGreater(report["poses"] if "poses" in report else report["scans"], 30, "a start while moving")
        self.assertEqual(report["status"][-1]["status"], "TRACKING")

    def test_it_dumps_by_itself_when_it_is_lost(self):
        self.start_daemon()
        self.start_drive("--rest", "2", "--duration", "40", "--fault", "lidar:off@8", "--fault", "imu:off@8")
        self.await_pose("LOST", lambda pose: pose["status"] == "LOST", 120.0)
        found = self.await_value("the dump", lambda: glob.glob(self.path("dumps/lost-*/dump.json")), 60.0)
        with open(found[0], encoding="utf-8") as file:
            self.assertIn("LOST", json.load(file)["reason"])
        self.await_value("its end", lambda: self.client.status()["health"]["flight_recorder"]["dumps"] == 1, 30.0)
        self.assertGreater(len(self.replay(os.path.dirname(found[0]))["status"]), 1)


if __name__ == "__main__":
    unittest.main()
