"""One long run through everything that the daemon does, for builds that watch themselves (sanitizers): start, drive with GPS, clients
of every kind, files, reload, failures of every sensor, LOST, a dump, kill -9, the checkpoint, the end. Such a build may be too slow
to track in real time, so nothing is said of that (what was not reached is printed): only that every request was answered, that it
ended well and that the program found no fault in itself.

Run by `tools/test --stage asan`, `tsan` and `rtsan` with SLAMD a program of that build and SLAM_SIM the release one.
"""

import array
import json
import os
import re
import signal
import socket
import time
import unittest

from harness import Client, EndToEndTest
from waiting import first_value

FINDING = re.compile(r"ERROR: \w*Sanitizer|WARNING: ThreadSanitizer|runtime error:|SUMMARY: \w+Sanitizer")
VERBS = ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent")
FAULT_S = 0.5
PATIENCE_S = 120.0
TRACKING_S = 45.0
LINES = ("{nonsense", "[]", '{"jsonrpc":"2.0","id":1,"method":"no_such_method"}', '{"jsonrpc":"2.0","id":1,"method":"get_map",'
         '"params":{"voxel_size_m":-1}}', "x" * 100_000)


class WholeRun(EndToEndTest):
    def setUp(self):
        super().setUp()
        for folder in ("state", "dumps"):
            os.mkdir(self.path(folder))
        with open(self.path("slamd.yaml"), "w", encoding="utf-8") as file:
            file.write("log:\n  repeat_period_s: 5.0\n")

    def tearDown(self):
        """What was found is told even when the test ended by something else, such as a connection that broke."""
        for process in self.processes:
            found = FINDING.search(process.output())
            if found or (not process.running() and process.child.returncode not in (0, -signal.SIGKILL)):
                begin = found.start() if found else -6000
                print(f"ended with {process.child.returncode}:\n{process.output()[begin:][:6000]}", flush=True)
        super().tearDown()

    def start_daemon(self, *extra):
        settings = {"health.allow_inject": "true", "checkpoint.folder": self.path("state"), "checkpoint.period_s": "2",
                    "flight_recorder.folder": self.path("dumps"), "flight_recorder.span_s": "20"}
        words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        return super().start_daemon("--config", self.path("slamd.yaml"), *words, *extra)

    def back_end(self):
        return self.client.status()["health"]["back_end"]

    def is_solved_with_gps(self):
        told = self.back_end()
        return told["enu"] is not None and told["changes"] > 0

    def give_time(self, what, attempt, seconds=TRACKING_S):
        """Goes on after that time all the same."""
        begin = time.monotonic()
        reached = first_value(attempt, seconds)
        print(f"{what}: {f'after {time.monotonic() - begin:.1f} s' if reached else 'not reached'}", flush=True)

    def is_tracking(self):
        pose = self.client.pose()
        return pose and pose["status"] == "TRACKING"

    def dumped(self):
        return self.client.status()["health"]["flight_recorder"]["dumps"] > 0

    def result_of(self, method, **params):
        answer = self.client.call(method, **params)
        self.assertIn("result", answer, (method, answer))
        return answer["result"]

    def test_nothing_is_found_in_a_run_through_everything(self):
        daemon = self.start_daemon("--record", self.path("recording"))
        self.start_simulator("--scenario", "campus", "--rest", "3", "--speed", "5")
        self.give_time("TRACKING", self.is_tracking)
        self.use_every_method()
        self.give_time("a graph solved with GPS", self.is_solved_with_gps)
        self.play_every_failure()
        self.reload(daemon)
        self.give_time("TRACKING", self.is_tracking)
        self.kill_and_come_back(daemon)

    def use_every_method(self):
        self.give_time("keyframes", lambda: self.client.status()["health"]["counts"]["keyframes"] > 10)
        subscribers = [Client(self.path("slamd.sock")) for _ in range(8)]  # one reads, the others only fill their queues
        for number, client in enumerate(subscribers):
            client.call("subscribe", topic="status" if number % 4 == 3 else "pose", rate_hz=(200, 50, 10, 4)[number % 4])
        for _ in range(20):
            self.assertTrue(subscribers[0].lines.readline())
        subscribers[0].call("unsubscribe", topic="pose")
        for method, params in (("version", {}), ("get_pose", {}), ("get_map", {}), ("get_map", {"format": "ply"}),
                               ("get_trajectory", {}), ("get_pose_page", {}), ("save_map", {"name": "map.pcd"}),
                               ("save_map", {"name": "map.ply"}), ("dump", {"name": "asked"})):
            self.ask_alone(method, params)
        for line in LINES:
            with socket.socket(socket.AF_UNIX) as stranger:
                stranger.connect(self.path("slamd.sock"))
                stranger.sendall(line.encode() + b"\n")
                stranger.recv(65536)
        for client in subscribers:
            client.close()

    def ask_alone(self, method, params):
        """On a connection of its own, for the descriptors that come along."""
        with socket.socket(socket.AF_UNIX) as client:
            client.settimeout(60.0)
            client.connect(self.path("slamd.sock"))
            client.sendall(json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": params}).encode() + b"\n")
            line = b""
            while not line.endswith(b"\n"):
                part, ancillary, _, _ = client.recvmsg(65536, socket.CMSG_SPACE(16))
                self.assertTrue(part, method)
                line += part
                for _, _, raw in ancillary:
                    for fd in array.array("i", raw[:len(raw) // 4 * 4]):
                        os.close(fd)
        self.assertIn("result", json.loads(line.splitlines()[-1]), (method, line[:300]))

    def play_every_failure(self):
        for verb in VERBS:
            for sensor in ("lidar", "imu", "gnss"):
                self.result_of("inject", sensor=sensor, verb=verb, for_s=FAULT_S)
                time.sleep(2.0 * FAULT_S)
        self.await_value("the end of the failures", lambda: not self.client.status()["health"]["injected"], PATIENCE_S)

    def reload(self, daemon):
        with open(self.path("slamd.yaml"), "w", encoding="utf-8") as file:
            file.write("log:\n  repeat_period_s: 1.0\n")
        daemon.send(signal.SIGHUP)
        self.await_value("the reload", lambda: "config state=reloaded" in daemon.output(), PATIENCE_S)

    def kill_and_come_back(self, daemon):
        """Twice: ended with care, then with none; each time with the map of before."""
        self.client.close()
        self.assert_clean_end(daemon)
        daemon = self.start_daemon()
        self.give_time("TRACKING", self.is_tracking)
        self.client.close()
        daemon.send(signal.SIGKILL)
        daemon.wait(PATIENCE_S)
        self.assertNotRegex(daemon.output(), FINDING)
        daemon = self.start_daemon()
        self.give_time("TRACKING", self.is_tracking)
        for sensor in ("lidar", "imu"):
            self.result_of("inject", sensor=sensor, verb="off", for_s=60.0)
        self.give_time("LOST and its dump", self.dumped)
        self.client.close()
        self.assert_clean_end(daemon)

    def assert_clean_end(self, daemon):
        daemon.send(signal.SIGTERM)
        code = daemon.wait(PATIENCE_S)
        self.assertNotRegex(daemon.output(), FINDING)
        self.assertEqual(code, 0, daemon.output()[-5000:])


if __name__ == "__main__":
    unittest.main()
