"""Whatever fails on the wires, the run goes on, says why, recovers, and the covariance covers the error. One drive a case, by
slam-sim and slam-replay, which come from ctest as SLAM_SIM and SLAM_REPLAY."""

import tempfile
import unittest

import fault_drives

# Worst error over the whole drive of 150 m (the same without a fault: 0.08 m; the tilt of the vertical at the start).
MAX_ERROR_M = 0.16
MAX_ERROR_WITHOUT_VERTICAL_M = 3.0  # without an IMU at rest the vertical is the vehicle's own: 0.5 to 1 degree
MIN_COVERED = 0.95

# From a fault's end to TRACKING: three scans, and what each sensor is doubted for by design.
MAX_RECOVERY_S = 0.3
DOUBT_OF_STUCK_IMU_S = 0.2   # odometry.imu_sanity.sane_again_s
DOUBT_OF_CLOCK_S = 1.0       # clock_unsure


class Faults(unittest.TestCase):
    def run_case(self, name):
        with tempfile.TemporaryDirectory(prefix="slamd-fault-") as folder:
            outcome = fault_drives.run(fault_drives.CASES[name], folder)
        self.assertGreater(len(outcome.stamps), 240, "the run should have gone on")
        self.assertGreater(outcome.stamps[-1], 29.0, "to the end of the drive")
        self.assertNotIn("LOST", outcome.statuses())
        return outcome

    def assert_accurate(self, outcome, max_error_m=MAX_ERROR_M):
        self.assertLess(outcome.worst_m(), max_error_m)
        self.assertGreater(outcome.covered_share(), MIN_COVERED, "of the poses the covariance covers the error")

    def assert_says_so_and_recovers(self, outcome, reason, doubt_s=0.0):
        case = outcome.case
        max_recovery_s = MAX_RECOVERY_S + doubt_s
        self.assertNotIn(reason, outcome.reasons(2.0, case.begin_s), "before the fault")
        self.assertIn(reason, outcome.reasons(case.begin_s, case.end_s + 0.2), "during the fault")
        self.assertNotIn(reason, outcome.reasons(case.end_s + max_recovery_s), "after the fault")
        self.assertLess(outcome.recovery_s(), max_recovery_s)
        self.assertEqual(outcome.status()[-1][2], "TRACKING")

    def assert_goes_on_without_imu(self, outcome):
        self.assertEqual(outcome.statuses() - {"INITIALISING"}, {"DEGRADED"})
        self.assertIn("no_imu", outcome.reasons(2.0))
        # A single scan that a guessed motion has skewed may contradict the map, and says so.
        self.assertLessEqual(outcome.reasons(2.0), {"no_imu", "innovation"})
        self.assert_accurate(outcome, MAX_ERROR_WITHOUT_VERTICAL_M)

    def assert_tracks_throughout(self, outcome):
        self.assertEqual({status for begin, _, status, _ in outcome.status() if begin > 2.0} - {"TRACKING"}, set())
        self.assertEqual(outcome.status()[-1][2], "TRACKING")

    def test_without_a_fault_it_tracks_throughout(self):
        outcome = self.run_case("none")
        self.assert_tracks_throughout(outcome)
        self.assert_accurate(outcome)

    def test_lost_packets_are_counted_and_change_little(self):
        outcome = self.run_case("loss")
        self.assert_tracks_throughout(outcome)
        self.assert_accurate(outcome)
        self.assertGreater(outcome.report["drops"]["lidar_packets_lost"], 200)

    def test_damaged_bytes_are_refused_by_cause_and_change_little(self):
        outcome = self.run_case("corrupt")
        self.assert_accurate(outcome)
        rejections = outcome.report["rejections"]
        self.assertGreater(rejections["imu"]["crc"], 50)
        self.assertGreater(sum(rejections["lidar"].values()), 0)
        self.assertGreater(rejections["gps"]["bad_checksum"] + rejections["gps"]["broken"], 0)
        degraded_s = sum(end - begin for begin, end, status, _ in outcome.status() if status == "DEGRADED")
        self.assertLess(degraded_s, 15.0, "some packets are refused whole, some scans are incomplete")

    def test_a_silent_lidar_is_said_and_survived(self):
        outcome = self.run_case("lidar_gap")
        self.assert_says_so_and_recovers(outcome, "no_lidar")
        self.assert_accurate(outcome)

    def test_a_silent_imu_is_said_and_survived(self):
        outcome = self.run_case("imu_gap")
        self.assert_says_so_and_recovers(outcome, "no_imu")
        self.assert_accurate(outcome)

    def test_a_stuck_imu_is_as_good_as_a_silent_one(self):
        outcome = self.run_case("imu_stuck")
        self.assert_says_so_and_recovers(outcome, "no_imu", DOUBT_OF_STUCK_IMU_S)
        self.assert_accurate(outcome)
        self.assertGreater(outcome.report["rejections"]["imu"]["frozen"], 300)

    def test_without_gps_nothing_changes(self):
        outcome = self.run_case("no_gps")
        self.assert_tracks_throughout(outcome)
        self.assert_accurate(outcome)

    def test_without_an_imu_it_goes_on_and_is_degraded_throughout(self):
        self.assert_goes_on_without_imu(self.run_case("no_imu"))

    def test_an_imu_stuck_since_it_was_switched_on_is_none(self):
        self.assert_goes_on_without_imu(self.run_case("imu_never_alive"))

    def test_an_imu_without_noise_is_believed_once_it_moves(self):
        outcome = self.run_case("imu_noiseless")
        moves_s = 3.0
        self.assertEqual(outcome.reasons(2.0, moves_s), {"no_imu"}, "at rest it looks stuck")
        self.assertEqual(outcome.status()[-1][2], "TRACKING")
        self.assertLess(outcome.status()[-1][0], moves_s + MAX_RECOVERY_S + DOUBT_OF_STUCK_IMU_S)
        self.assert_accurate(outcome, MAX_ERROR_WITHOUT_VERTICAL_M)

    def test_a_jump_of_the_lidars_clock_is_followed(self):
        outcome = self.run_case("lidar_jump")
        self.assert_says_so_and_recovers(outcome, "clock_unsure", DOUBT_OF_CLOCK_S)
        self.assert_accurate(outcome)

    def test_a_jump_of_the_imus_clock_is_followed(self):
        outcome = self.run_case("imu_jump")
        self.assert_says_so_and_recovers(outcome, "clock_unsure", DOUBT_OF_CLOCK_S)
        self.assert_accurate(outcome)


if __name__ == "__main__":
    unittest.main()
