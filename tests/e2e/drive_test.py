"""A simulated drive through the real daemon: the pose against the truth, and what it says when sensors go and come back."""

import math
import signal
import time
import unittest

from harness import EndToEndTest, in_real_time
from rigid import Truth, errors, relative


def transform(pose):
    T_odom_base = pose["T_odom_base"]
    return tuple(T_odom_base["translation_m"]), tuple(T_odom_base["rotation_quat_xyzw"])


def is_tracking(pose):
    return pose["status"] == "TRACKING"


def has_reason(*reasons):
    return lambda pose: pose["status"] in ("DEGRADED", "LOST") and set(reasons) <= set(pose["reasons"])


class Drive(EndToEndTest):
    def sample_poses(self, seconds):
        """Poses of the coming seconds, about twenty a second."""
        poses = []
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            poses.append(self.client.pose())
            time.sleep(0.05)
        return poses

    @in_real_time
    def test_the_pose_follows_the_truth_at_200_hz_and_nothing_is_dropped(self):
        daemon = self.start_daemon()
        self.start_simulator("--rest", "3", "--duration", "100")
        self.await_pose("tracking", is_tracking, 60.0)
        poses = self.sample_poses(25.0)
        status = self.client.status()
        self.assert_stops_cleanly(daemon)
        self.check_status(poses)
        self.check_rate(poses)
        self.check_against_truth(poses)
        self.check_health(status["health"])

    def check_status(self, poses):
        """On a busy machine the simulator itself may be late by more than a sensor may be silent: the daemon says so."""
        tracking = sum(is_tracking(pose) for pose in poses)
        self.assertGreater(tracking, 0.9 * len(poses), {str(pose["reasons"]) for pose in poses})
        for pose in poses:
            self.assertTrue(is_tracking(pose) or {"imu_gap", "no_imu", "no_lidar"} & set(pose["reasons"]), pose)

    def check_rate(self, poses):
        samples = poses[-1]["sequence"] - poses[0]["sequence"]
        seconds = (poses[-1]["time_ns"] - poses[0]["time_ns"]) * 1e-9
        self.assertGreater(samples / seconds, 190.0)
        self.assertLess(samples / seconds, 230.0)

    def check_against_truth(self, poses):
        """Relative to the first moving pose: what is learnt of gravity at the first metre is the estimator's tests' matter."""
        truth = Truth(self.path("truth.tum"))
        poses = [pose for pose in poses if pose["time_ns"] * 1e-9 < truth.stamps[-1]]
        poses = poses[next(i for i, pose in enumerate(poses) if math.hypot(*pose["velocity_mps"]) > 3.0):]
        begin_time, begin = poses[0]["time_ns"] * 1e-9, transform(poses[0])
        driven = errors(truth.at(begin_time), truth.at(poses[-1]["time_ns"] * 1e-9))[0]
        self.assertGreater(driven, 20.0, "the vehicle should have moved")
        for pose in poses:
            expected = relative(truth.at(begin_time), truth.at(pose["time_ns"] * 1e-9))
            distance_m, angle_rad = errors(expected, relative(begin, transform(pose)))
            self.assertLess(distance_m, 0.30)
            self.assertLess(angle_rad, 0.02)

    def check_health(self, health):
        for name, ring in health["rings"].items():
            self.assertEqual(ring["dropped"], 0, name)
        for name in ("lidar", "imu", "gnss"):
            self.assertEqual(health["sources"][name]["state"], "healthy", name)
        self.assertGreater(health["counts"]["keyframes"], 5)
        self.assertGreater(health["counts"]["gnss_fixes"], 10)

    @in_real_time
    def test_a_silent_imu_is_degraded_and_it_recovers(self):
        daemon = self.start_daemon()
        self.start_simulator("--rest", "3", "--duration", "60", "--fault", "imu:off@14+5")
        self.await_pose("tracking", is_tracking, 60.0)
        degraded = self.await_pose("no_imu", has_reason("no_imu"))
        self.await_pose("tracking again", is_tracking)
        self.assertEqual(degraded["status"], "DEGRADED")
        self.await_value("the log", lambda: "imu state=faulty reason=silent" in daemon.output(), 30.0)
        self.assert_stops_cleanly(daemon)

    @in_real_time
    def test_a_silent_lidar_is_degraded_and_it_recovers(self):
        daemon = self.start_daemon()
        self.start_simulator("--rest", "3", "--duration", "60", "--fault", "lidar:off@14+3")
        self.await_pose("tracking", is_tracking, 60.0)
        degraded = self.await_pose("no_lidar", has_reason("no_lidar"))
        self.await_pose("tracking again", is_tracking)
        self.assertNotIn("no_imu", degraded["reasons"])
        self.await_value("the log", lambda: "lidar state=faulty reason=silent" in daemon.output(), 30.0)
        self.assert_stops_cleanly(daemon)

    @in_real_time
    def test_all_devices_may_be_pulled_out_and_come_back(self):
        daemon = self.start_daemon()
        drive = self.start_simulator("--trajectory", "standstill", "--duration", "60")
        self.await_pose("tracking", is_tracking, 60.0)
        drive.send(signal.SIGKILL)
        self.await_pose("both missing", has_reason("no_imu", "no_lidar"))
        self.await_value("the log", lambda: "imu state=absent" in daemon.output().split("imu state=healthy")[-1], 30.0)
        self.start_simulator("--trajectory", "standstill", "--duration", "60")
        self.await_pose("tracking again", is_tracking, 60.0)
        self.assert_stops_cleanly(daemon)


if __name__ == "__main__":
    unittest.main()
