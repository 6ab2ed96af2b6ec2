"""The other LiDARs through the real daemon: a RoboSense Airy over UDP to a pose, an RPLIDAR A2 over its serial port to scans."""

import unittest

from harness import EndToEndTest, in_real_time


def is_tracking(pose):
    return pose["status"] == "TRACKING"


class Lidars(EndToEndTest):
    @in_real_time
    def test_an_rplidar_is_started_and_scans(self):
        daemon = self.start_daemon("--set", "lidar.model=rplidar_a2", "--set", "mode=planar", "--set", f"lidar.device={self.path('a2')}")
        self.start_simulator("--lidar", "rplidar_a2", "--world", "parking", "--lidar-pty", self.path("a2"), "--rest", "3", "--duration", "60")
        source = self.await_value("scans", self.scans_above(50), 60.0)
        self.assertEqual(source["rejected"], {}, source)
        self.assert_stops_cleanly(daemon)

    def scans_above(self, count):
        def attempt():
            source = self.client.status()["health"]["sources"]["lidar"]
            return source if source["received"] > count else None

        return attempt

    @in_real_time
    def test_an_airy_is_tracked_with(self):
        daemon = self.start_daemon("--set", "lidar.model=airy")
        self.start_simulator("--lidar", "airy", "--world", "parking", "--rest", "3", "--duration", "60")
        self.await_pose("tracking", is_tracking, 60.0)
        source = self.client.status()["health"]["sources"]["lidar"]
        self.assertGreater(source["received"], 1000, source)
        self.assertEqual(set(source["rejected"]) - {"no_angles"}, set(), source)
        self.assert_stops_cleanly(daemon)


if __name__ == "__main__":
    unittest.main()
