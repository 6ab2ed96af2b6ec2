"""Failures played on the running daemon: it says so, the pose stays near the truth, and it recovers by itself into the same map when
the sensor is back. Three of them on one drive; with SLAMD_ALL_FAULTS=1 every verb on every sensor, a drive each."""

import os
import unittest

from harness import in_real_time
from inject_drives import AFTER_S, FAULT_S, SENSORS, VERBS, InjectDrive

MAX_ERROR_M = 1.0  # of some 100 m driven from the failure's begin on; docs/faults.md has what was measured
MAX_WRONG_M = 20.0  # while a sensor that is wrong without a contradiction in itself is believed
MAX_TRACKING_AGAIN_S = 3.0


class Injected(InjectDrive):
    def check(self, outcome):
        what = (outcome.sensor, outcome.verb)
        self.assertNotIn("reset", outcome.reasons(), what)
        self.assertEqual(outcome.samples[-1].pose["status"], "TRACKING", what)
        # A busy machine's kernel holds a pty up for longer than a scan's deadline now and then: bridged, and no failure's.
        self.assertLess(outcome.without_hiccups().tracking_again_s(), MAX_TRACKING_AGAIN_S, what)
        self.assertLess(outcome.worst_m(), MAX_WRONG_M if outcome.verb == "wrong" else MAX_ERROR_M, what)
        self.assertIsNotNone(outcome.healthy_again_s(), (what, outcome.samples[-1].states))

    @in_real_time
    def test_three_failures_on_one_drive_are_said_and_forgotten(self):
        daemon = self.start_drive(80.0)
        for sensor, verb, fault_s, after_s in (("imu", "stuck", 2.0, 6.0), ("lidar", "off", 2.0, 6.0), ("gnss", "off", 4.0, 6.0)):
            outcome = self.play(sensor, verb, fault_s, after_s)
            self.check(outcome)
            self.assertIn(outcome.state()[0], ("faulty", "degraded"), (sensor, verb))
            if sensor != "gnss":
                self.assertEqual(outcome.status(), "DEGRADED")
                self.assertIn({"imu": "no_imu", "lidar": "no_lidar"}[sensor], outcome.reasons())
        self.assertIn("injection state=failing reason=imu_stuck", daemon.output())
        self.assert_stops_cleanly(daemon)

    @unittest.skipUnless(os.environ.get("SLAMD_ALL_FAULTS"), "a quarter of an hour: SLAMD_ALL_FAULTS=1 asks for it")
    def test_every_failure_of_every_sensor_is_forgotten(self):
        for sensor in SENSORS:
            for verb in VERBS:
                with self.subTest(sensor=sensor, verb=verb):
                    self.start_drive(60.0 + FAULT_S[sensor] + AFTER_S[sensor], with_place=sensor == "gnss")
                    self.check(self.play(sensor, verb))
                self.tearDown()
                self.setUp()


class Refused(InjectDrive):
    def test_nothing_is_played_where_the_configuration_does_not_allow_it(self):
        self.start_daemon()
        self.assertEqual(self.client.call("inject", sensor="imu", verb="off")["error"]["code"], -32007)
        self.assertNotIn("injected", self.client.status()["health"])


if __name__ == "__main__":
    unittest.main()
