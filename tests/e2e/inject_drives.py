"""A simulated drive through the real daemon with failures played on a sensor by `slamctl inject`'s method, measured against the
truth. Judges nothing: inject_test.py does.

As a program it prints the table of docs/faults.md, a drive a row (a quarter of an hour, in real time):
    SLAMD=.../slamd SLAM_SIM=.../slam-sim python3 tests/e2e/inject_drives.py [SENSOR VERB]
"""

import dataclasses
import math
import sys
import time

from harness import EndToEndTest
from rigid import Truth, errors, relative

VERBS = ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent")
SENSORS = ("lidar", "imu", "gnss")
FAULT_S = {"lidar": 4.0, "imu": 4.0, "gnss": 15.0}
AFTER_S = {"lidar": 12.0, "imu": 12.0, "gnss": 30.0}  # that a sensor may take to be trusted again
WORST_FIRST = ("LOST", "DEGRADED", "INITIALISING", "TRACKING")
WORST_STATE_FIRST = ("faulty", "absent", "degraded", "starting", "healthy")
CHI_SQUARE_3_999 = 16.27  # a true covariance has 99.9 % of the errors inside


@dataclasses.dataclass(frozen=True)
class Sample:
    """What the daemon said at one instant."""

    time_s: float
    pose: dict
    states: dict  # of each sensor: (state, reason)

    def place(self, frame):
        transform = self.pose[f"T_{frame}_base"]
        return tuple(transform["translation_m"]), tuple(transform["rotation_quat_xyzw"])


@dataclasses.dataclass
class Outcome:
    """What became of one failure: samples from its begin until it should be forgotten."""

    sensor: str
    verb: str
    begin_s: float
    end_s: float
    samples: list
    truth: Truth = None

    def error_m(self, sample, frame="odom"):
        """Of the way since the failure began."""
        first = self.samples[0]
        truly = relative(self.truth.at(first.time_s), self.truth.at(sample.time_s))
        return errors(truly, relative(first.place(frame), sample.place(frame)))[0]

    def known(self):
        """Samples whose truth is already written."""
        return [sample for sample in self.samples if sample.time_s < self.truth.stamps[-1]]

    def worst_m(self):
        return max(self.error_m(sample) for sample in self.known() if sample.time_s < self.end_s + 1.0)

    def last_m(self, frame="odom"):
        return self.error_m(self.known()[-1], frame)

    def sigma_m(self):
        """Largest position sigma that was said, the root of the three axes' sum."""
        return max(math.sqrt(sum(sample.pose["covariance"][i * 7] for i in range(3))) for sample in self.samples)

    def status(self):
        said = {sample.pose["status"] for sample in self.samples}
        return next(status for status in WORST_FIRST if status in said)

    def reasons(self):
        return set().union(*(sample.pose["reasons"] for sample in self.samples))

    def state(self):
        """The worst of the sensor, with its reason."""
        said = [sample.states[self.sensor] for sample in self.samples]
        return min(said, key=lambda state: WORST_STATE_FIRST.index(state[0]))

    def again_s(self, good):
        """From the failure's end until good(sample) holds to the end of the samples; None when it never does."""
        if not good(self.samples[-1]):
            return None
        bad = [sample.time_s for sample in self.samples if not good(sample)]
        return max(0.0, max(bad, default=self.end_s) - self.end_s)

    def tracking_again_s(self):
        return self.again_s(lambda sample: sample.pose["status"] == "TRACKING")

    def without_hiccups(self):
        """Leaves out samples that say nothing but `imu_gap` and stand alone: TRACKING half a second before and after."""
        def tracks(time_s):
            near = min(self.samples, key=lambda sample: abs(sample.time_s - time_s))
            return near.pose["status"] == "TRACKING"

        def is_hiccup(sample):
            alone = tracks(sample.time_s - 0.5) and tracks(sample.time_s + 0.5)
            return sample.pose["reasons"] == ["imu_gap"] and alone

        return dataclasses.replace(self, samples=[sample for sample in self.samples if not is_hiccup(sample)])

    def healthy_again_s(self):
        return self.again_s(lambda sample: sample.states[self.sensor][0] == "healthy")


class InjectDrive(EndToEndTest):
    """A daemon that allows failures, and a drive that moves."""

    def start_drive(self, duration_s, with_place=False):
        """with_place: until GPS has told the map its place on the earth; a lie before that is the first truth that it hears."""
        daemon = self.start_daemon("--set", "health.allow_inject=true")
        self.start_simulator("--rest", "3", "--duration", str(duration_s))
        self.await_pose("driving", lambda pose: pose["status"] == "TRACKING" and math.hypot(*pose["velocity_mps"]) > 4.0)
        self.await_value("healthy sensors", lambda: all(state == "healthy" for state, _ in self.states().values()), 30.0)
        if with_place:
            self.await_value("a place on the earth", self.has_place, 60.0)
        return daemon

    def has_place(self):
        told = self.client.status()["health"]["back_end"]
        return told["enu"] is not None and told["gnss"]["trust"] == "trusted"

    def states(self):
        sources = self.client.status()["health"]["sources"]
        return {name: (sources[name]["state"], sources[name]["reason"]) for name in SENSORS}

    def sample(self):
        pose = self.client.pose()
        return Sample(pose["time_ns"] * 1e-9, pose, self.states())

    def play(self, sensor, verb, fault_s=None, after_s=None):
        """Plays one failure and watches until it should be forgotten."""
        fault_s = fault_s or FAULT_S[sensor]
        first = self.sample()
        begin_s = time.monotonic()
        if verb != "none":
            answer = self.client.call("inject", sensor=sensor, verb=verb, for_s=fault_s)
            self.assertIn("result", answer)
        outcome = Outcome(sensor, verb, begin_s, begin_s + fault_s, [first])
        while time.monotonic() < outcome.end_s + (after_s or AFTER_S[sensor]):
            outcome.samples.append(self.sample())
            time.sleep(0.05)
        outcome.truth = Truth(self.path("truth.tum"))
        return outcome


def row(outcome):
    def seconds(value):
        return "never" if value is None else f"{value:.1f} s"

    state, reason = outcome.state()
    sensor = {"gnss": "GPS", "imu": "IMU", "lidar": "LiDAR"}[outcome.sensor]
    what = f"{sensor} | {outcome.verb}" if outcome.verb != "none" else "- | no failure"
    return (f"| {what} | {state} ({reason}) | {outcome.status()} | "
            f"{', '.join(sorted(outcome.reasons())) or '-'} | {outcome.worst_m():.2f} | {outcome.last_m():.2f} | "
            f"{outcome.last_m('map'):.2f} | {outcome.sigma_m():.2f} | {seconds(outcome.tracking_again_s())} | "
            f"{seconds(outcome.healthy_again_s())} |")


def one_drive(sensor, verb):
    test = InjectDrive("run")
    test.setUp()
    try:
        test.start_drive(60.0 + FAULT_S[sensor] + AFTER_S[sensor], with_place=sensor == "gnss")
        return test.play(sensor, verb)
    finally:
        test.tearDown()


def main():
    print("| sensor | verb | its state | status | reasons | worst error during it, m | error at the end, m | "
          "error in map, m | largest sigma, m | TRACKING again after | sensor healthy again after |")
    print("| --- " * 11 + "|")
    cases = [tuple(sys.argv[1:3])] if sys.argv[1:] else [("lidar", "none")] + [(s, v) for s in SENSORS for v in VERBS]
    for sensor, verb in cases:
        print(row(one_drive(sensor, verb)), flush=True)


if __name__ == "__main__":
    sys.exit(main())
