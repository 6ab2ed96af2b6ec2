"""The firmware's image on the emulated board feeds the real daemon through a pty, while slam-sim sends LiDAR and GPS of the same
drive: the pose is as good as with slam-sim's own IMU bytes (`drive_test`: seen from the first metres, a few centimetres)."""

import math
import os
import subprocess
import tty
import unittest

from harness import EndToEndTest, Process, hurry, in_real_time
from rigid import Truth, errors, relative

DRIVE = ["--rest", "3", "--duration", "20", "--seed", "4"]
START_DELAY_S = 10  # for the emulator to get ahead of the clock
LINGER_S = 5


def transform(pose):
    T_odom_base = pose["T_odom_base"]
    return tuple(T_odom_base["translation_m"]), tuple(T_odom_base["rotation_quat_xyzw"])


class Bridge(Process):
    """The emulated board with its serial port on a new pty, which `link` names; it moves as the file says."""

    def __init__(self, link, motion, log_path):
        self.log_path = log_path
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)
        os.symlink(os.ttyname(self.slave), link)
        with open(log_path, "wb") as log:
            self.child = subprocess.Popen([os.environ["SLAMD_NODE"], os.environ["SLAMD_BRIDGE"], motion, "--linger", str(LINGER_S)],
                                          stdin=subprocess.DEVNULL, stdout=self.master, stderr=log, preexec_fn=hurry)

    def send(self, signal_number):
        """It says how late it was only when it ends by itself."""

    def stop(self):
        super().stop()
        os.close(self.master)
        os.close(self.slave)


class EmulatedImu(EndToEndTest):
    def start_bridge(self):
        motion = self.path("motion.csv")
        self.await_value("the motion file", lambda: os.path.exists(motion), 60.0)
        bridge = Bridge(self.path("imu"), motion, self.path("bridge.log"))
        self.processes.append(bridge)
        return bridge

    def start_simulator_without_imu(self):
        self.start("slam-sim", [os.environ["SLAM_SIM"], "--live", "--no-imu", "--imu-motion", self.path("motion.csv"), "--gps-pty",
                                self.path("gnss"), "--lidar-port", str(self.port), "--position-port", str(self.position_port),
                                "--truth", self.path("truth.tum"), "--start-delay", str(START_DELAY_S), *DRIVE], hurry)

    def final_error(self):
        """Metres and radians of the last pose before the end of the drive, relative to the first metre driven; and the distance."""
        moving = self.await_pose("moving", lambda pose: math.hypot(*pose["velocity_mps"]) > 3.0)
        poses = [moving]
        self.await_value("the end of the drive", lambda: self.ended(poses), 120.0)
        truth = Truth(self.path("truth.tum"))
        last = [pose for pose in poses if pose["time_ns"] * 1e-9 < truth.stamps[-1]][-1]
        begin, end = (truth.at(pose["time_ns"] * 1e-9) for pose in (moving, last))
        distance_m, angle_rad = errors(relative(begin, end), relative(transform(moving), transform(last)))
        return distance_m, angle_rad, errors(begin, end)[0]

    def ended(self, poses):
        poses.append(self.client.pose())
        return not self.processes[1].running()

    @in_real_time
    def test_the_pose_with_the_emulated_board_follows_the_truth(self):
        daemon = self.start_daemon()
        self.start_simulator_without_imu()
        bridge = self.start_bridge()
        error_m, angle_rad, driven_m = self.final_error()
        health = self.client.status()["health"]
        self.assert_stops_cleanly(daemon)
        print(f"{error_m:.3f} m, {angle_rad:.4f} rad after {driven_m:.0f} m as the crow flies")
        self.assertEqual(bridge.wait(60.0), 0, bridge.output())
        print(bridge.output().strip())
        self.assertGreater(driven_m, 30.0)
        self.assertLess(error_m, 0.10)
        self.assertLess(angle_rad, 0.02)
        self.assertGreater(health["counts"]["gnss_fixes"], 10)
        self.assertEqual(health["sources"]["imu"]["state"], "healthy")


if __name__ == "__main__":
    unittest.main()
