"""The daemon in planar mode, fed live: poses against the truth, the occupancy grid against what the LiDAR was shown, and a map
that outlives kill -9."""

import math
import os
import signal
import subprocess
import unittest

from harness import EndToEndTest, in_real_time

OCCUPIED, FREE = 100, 0
SLAMCTL = os.environ.get("SLAMCTL", "slamctl")


def yaw_of(pose):
    x, y, z, w = pose["rotation_quat_xyzw"]
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


class Grid:
    """A map_server picture with its YAML."""

    def __init__(self, path):
        with open(path, "rb") as file:
            magic, size, most, self.cells = file.read().split(b"\n", 3)
        assert (magic, most) == (b"P5", b"255")
        self.width, self.height = map(int, size.split())
        with open(path.replace(".pgm", ".yaml"), encoding="ascii") as file:
            told = dict(line.strip().split(": ", 1) for line in file)
        self.resolution = float(told["resolution"])
        self.origin = [float(number) for number in told["origin"].strip("[]").split(",")]

    def at(self, x, y):
        column = math.floor((x - self.origin[0]) / self.resolution)
        row = self.height - 1 - math.floor((y - self.origin[1]) / self.resolution)
        inside = 0 <= column < self.width and 0 <= row < self.height
        return self.cells[row * self.width + column] if inside else 205

    def counts(self):
        return {grey: self.cells.count(bytes([grey])) for grey in (0, 205, 254)}


class Planar(EndToEndTest):
    def start_daemon(self, *extra):
        return super().start_daemon("--set", "mode=planar", "--set", f"checkpoint.folder={self.path('.')}",
                                    "--set", "checkpoint.period_s=2", *extra)

    def start_drive(self, *extra):
        return self.start_simulator("--scenario", "parking", *extra)

    def back_end(self):
        return self.client.status()["health"]["back_end"]

    def await_tracking(self):
        return self.await_pose("TRACKING", lambda pose: pose["status"] == "TRACKING")

    def fetch_grid(self):
        path = self.path("map.pgm")
        subprocess.run([SLAMCTL, "--socket", self.path("slamd.sock"), "grid", "--out", path], check=True, capture_output=True,
                       timeout=60)
        return Grid(path)

    def truth(self):
        """By host time in ns: x, y, z and the quaternion of base; whole lines alone."""
        poses = {}
        with open(self.path("truth.tum"), encoding="ascii") as file:
            for line in file.read().split("\n")[:-1]:
                stamp, *numbers = line.split()
                seconds, fraction = stamp.split(".")
                poses[int(seconds) * 10**9 + int(fraction)] = [float(number) for number in numbers]
        return poses

    def truth_relative_to_start(self, time_ns):
        """Base at that time in base at the start; x, y, yaw. The simulator writes the truth half a second behind."""
        poses = self.await_value("the truth", lambda: self.truth() if max(self.truth(), default=0) >= time_ns else None, 10.0)
        first = poses[min(poses)]
        now = poses[min(poses, key=lambda stamp: abs(stamp - time_ns))]

        def heading(pose):
            return yaw_of({"rotation_quat_xyzw": pose[3:]})

        dx, dy = now[0] - first[0], now[1] - first[1]
        c, s = math.cos(heading(first)), math.sin(heading(first))
        return c * dx + s * dy, -s * dx + c * dy, heading(now) - heading(first)

    @in_real_time
    def test_a_drive_is_followed_and_the_grid_shows_where_it_went(self):
        daemon = self.start_daemon()
        self.start_drive("--rest", "2", "--duration", "25")
        self.await_tracking()
        path = [self.await_pose("the start", lambda pose: True)["T_map_base"]["translation_m"]]

        def has_gone(metres):
            def judge(pose):
                at = pose["T_map_base"]["translation_m"]
                if math.dist(at, path[-1]) > 0.5:
                    path.append(at)
                return pose["status"] == "TRACKING" and math.dist(at, path[0]) > metres
            return judge

        far = self.await_pose("30 m", has_gone(30.0), 60.0)
        wanted = self.back_end()["keyframes"]
        self.await_value("a grid of all of it", lambda: self.back_end()["grid_keyframes"] >= wanted, 60.0)
        x, y, yaw = self.truth_relative_to_start(far["time_ns"])
        self.assertLess(math.hypot(far["T_map_base"]["translation_m"][0] - x, far["T_map_base"]["translation_m"][1] - y), 0.3)
        self.assertLess(abs(math.remainder(yaw_of(far["T_map_base"]) - yaw, 2 * math.pi)), 0.03)

        grid = self.fetch_grid()
        driven = [grid.at(p[0], p[1]) for p in path]
        self.assertGreater(driven.count(254) / len(driven), 0.9, "where the vehicle was is free")
        counts = grid.counts()
        self.assertGreater(counts[0], 500)
        self.assertGreater(counts[254], 5 * counts[0])
        self.assertGreater(self.back_end()["keyframes"], 20)
        self.assert_stops_cleanly(daemon)

    @in_real_time
    def test_subscribers_hear_of_new_grids(self):
        self.start_daemon()
        self.start_drive("--rest", "1", "--duration", "20")
        self.await_tracking()
        self.assertIn("result", self.client.call("subscribe", topic="grid", rate_hz=4))
        told = []
        while len(told) < 3:
            message = self.client.next_notification()
            if message["method"] == "grid":
                told.append(message["params"])
        self.assertEqual(sorted({grid["changes"] for grid in told}), [grid["changes"] for grid in told])

    @in_real_time
    def test_a_lidar_that_falls_silent_is_told_and_comes_back(self):
        self.start_daemon()
        self.start_drive("--rest", "30", "--duration", "30", "--fault", "lidar:gap@5+3")
        self.await_tracking()
        silent = self.await_pose("DEGRADED", lambda pose: pose["status"] != "TRACKING")
        self.assertIn("no_lidar", silent["reasons"])
        self.await_tracking()

    @in_real_time
    def test_killed_at_rest_it_goes_on_in_the_same_map(self):
        daemon = self.start_daemon()
        self.start_drive("--rest", "15", "--duration", "40")
        before = self.await_tracking()["T_map_base"]["translation_m"]
        self.await_value("a checkpoint", lambda: self.client.status()["health"]["checkpoint"]["written"] > 0, 30.0)
        self.client.close()
        daemon.send(signal.SIGKILL)
        daemon.wait(30.0)
        daemon = self.start_daemon()
        self.await_value("the verdict", lambda: self.back_end()["relocalised"] + self.back_end()["maps_begun_anew"] > 0, 60.0)
        self.assertEqual((self.back_end()["relocalised"], self.back_end()["maps_begun_anew"]), (1, 0))
        self.assertLess(math.dist(self.await_tracking()["T_map_base"]["translation_m"], before), 0.1)
        self.await_value("the log", lambda: "map state=relocalised" in daemon.output(), 10.0)
        far = self.await_pose("20 m", lambda pose: math.dist(pose["T_map_base"]["translation_m"], before) > 20.0)
        x, y, _ = self.truth_relative_to_start(far["time_ns"])
        self.assertLess(math.hypot(far["T_map_base"]["translation_m"][0] - x, far["T_map_base"]["translation_m"][1] - y), 0.3)

    def test_damaged_checkpoints_are_refused_with_a_reason(self):
        for content in (b"", b"SLAMDGRD", os.urandom(3000)):
            with open(self.path("planar.map"), "wb") as file:
                file.write(content)
            daemon = self.start_daemon()
            told = "checkpoint state=refused" if content else "checkpoint state=none"
            self.await_value("the refusal", lambda: told in daemon.output(), 10.0)
            self.client.close()
            self.assert_stops_cleanly(daemon)


if __name__ == "__main__":
    unittest.main()
