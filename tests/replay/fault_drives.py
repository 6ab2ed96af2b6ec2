"""Simulated drives with faults through slam-replay, measured against the truth. Judges nothing: fault_test.py does.

As a program it prints the table of docs/faults.md:
    PYTHONPATH=tests/support SLAM_SIM=.../slam-sim SLAM_REPLAY=.../slam-replay python3 tests/replay/fault_drives.py
"""

import dataclasses
import json
import math
import os
import subprocess
import sys
import tempfile

from rigid import Truth, conjugate, multiply, rotate

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HOST_START_S = 1000.0  # slam-sim's default
CHI_SQUARE_3_999 = 16.27  # a true covariance has 99.9 % of the errors inside


@dataclasses.dataclass(frozen=True)
class Case:
    """A drive: `begin_s` and `end_s` bound the fault (None: it is there all the time)."""

    name: str
    options: tuple
    begin_s: float | None = None
    end_s: float | None = None
    scenario: str = "campus"
    seed: int = 3


def fault(name, *faults, begin_s=None, length_s=0.0, more=()):
    when = "" if begin_s is None else f"@{begin_s:g}" + (f"+{length_s:g}" if length_s else "")
    options = [word for text in faults for word in ("--fault", text + when)]
    return Case(name, ("--rest", "3", *options, *more), begin_s, None if begin_s is None else begin_s + length_s)


CASES = {
    "none": fault("no fault"),
    "loss": fault("2 % of LiDAR packets lost", "lidar:loss=0.02"),
    "corrupt": fault("damaged bytes on all three wires", "lidar:corrupt=1e-4", "imu:corrupt=1e-3", "gps:corrupt=1e-3"),
    "lidar_gap": fault("LiDAR silent for 3 s", "lidar:gap", begin_s=12.0, length_s=3.0),
    "imu_gap": fault("IMU silent for 2 s", "imu:gap", begin_s=12.0, length_s=2.0),
    "imu_stuck": fault("IMU repeats one measurement for 2 s", "imu:stuck", begin_s=12.0, length_s=2.0),
    "imu_never_alive": fault("IMU stuck since it was switched on", "imu:stuck", begin_s=0.001, length_s=1000.0),
    "imu_noiseless": fault("IMU without noise, which repeats itself at rest", more=("--ideal-imu",)),
    "no_gps": fault("no GPS", more=("--no-gps",)),
    "no_imu": fault("no IMU at all", more=("--no-imu",)),
    "lidar_jump": fault("LiDAR's clock jumps by 0.25 s", "lidar:clock-jump=250", begin_s=12.0),
    "imu_jump": fault("IMU's clock jumps by 0.25 s", "imu:clock-jump=250", begin_s=12.0),
}


@dataclasses.dataclass
class Outcome:
    """What became of a case. Errors in metres against the truth, from the first pose on."""

    case: Case
    report: dict
    stamps: list
    errors_m: list
    squares: list  # normalised by the covariance of that pose, 3 degrees of freedom

    def worst_m(self, from_s=0.0, to_s=math.inf):
        return max((e for t, e in zip(self.stamps, self.errors_m) if from_s <= t <= to_s), default=0.0)

    def covered_share(self):
        """Of the poses, those whose covariance covers their error with 99.9 %."""
        return sum(square < CHI_SQUARE_3_999 for square in self.squares) / len(self.squares)

    def status(self):
        """(begin, end, status, reasons) of each stretch, seconds of the drive."""
        line = self.report["status"]
        ends = [entry["t_s"] for entry in line[1:]] + [HOST_START_S + self.stamps[-1]]
        return [(entry["t_s"] - HOST_START_S, end - HOST_START_S, entry["status"], set(entry["reasons"]))
                for entry, end in zip(line, ends)]

    def reasons(self, from_s=0.0, to_s=math.inf):
        """Reasons that were given at any time of the stretch."""
        return set().union(*(r for begin, end, _, r in self.status() if end > from_s and begin < to_s))

    def statuses(self):
        return {status for _, _, status, _ in self.status()}

    def recovery_s(self):
        """From the fault's end to the last moment that was not TRACKING."""
        after = [end for _, end, status, _ in self.status() if status != "TRACKING" and end > self.case.end_s]
        return max(after, default=self.case.end_s) - self.case.end_s


def seconds(stamp):
    return float(stamp) - HOST_START_S


def read_poses(path):
    with open(path, encoding="ascii") as file:
        for line in file:
            stamp, *numbers = line.split()
            values = list(map(float, numbers))
            yield seconds(stamp), tuple(values[:3]), tuple(values[3:])


def read_position_covariances(path):
    """The 3x3 blocks of covariance.csv (upper triangles by rows)."""
    with open(path, encoding="ascii") as file:
        for line in file:
            c = list(map(float, line.split(",")[1:]))
            yield ((c[0], c[1], c[2]), (c[1], c[6], c[7]), (c[2], c[7], c[11]))


def normalised_square(e, p):
    """e' P^-1 e of a symmetric 3x3 matrix, by its adjugate; a millimetre for what the truth file itself may be off."""
    (a, b, c), (_, d, f), (_, _, g) = p
    a, d, g = a + 1e-6, d + 1e-6, g + 1e-6
    adjugate = ((d * g - f * f, c * f - b * g, b * f - c * d), (c * f - b * g, a * g - c * c, b * c - a * f),
                (b * f - c * d, b * c - a * f, a * d - b * b))
    determinant = a * adjugate[0][0] + b * adjugate[0][1] + c * adjugate[0][2]
    return sum(e[i] * adjugate[i][j] * e[j] for i in range(3) for j in range(3)) / determinant


class Alignment:
    """World to odom by one pose in both: what odom is, its vertical included, is settled there."""

    def __init__(self, pose, truth):
        self.rotation = multiply(pose[1], conjugate(truth[1]))
        self.translation = [p - r for p, r in zip(pose[0], rotate(self.rotation, truth[0]))]

    def position(self, world):
        return [t + r for t, r in zip(self.translation, rotate(self.rotation, world))]


def measure(case, drive, out):
    truth = Truth(os.path.join(drive, "truth.tum"))
    with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
        outcome = Outcome(case, json.load(file), [], [], [])
    alignment = None
    poses = read_poses(os.path.join(out, "odom.tum"))
    for (t, p, q), covariance in zip(poses, read_position_covariances(os.path.join(out, "covariance.csv"))):
        true_pose = truth.at(HOST_START_S + t)
        alignment = alignment or Alignment((p, q), true_pose)
        error = [a - b for a, b in zip(p, alignment.position(true_pose[0]))]
        outcome.stamps.append(t)
        outcome.errors_m.append(math.hypot(*error))
        outcome.squares.append(normalised_square(error, covariance))
    return outcome


def run(case, folder, duration_s=30.0):
    drive, out = os.path.join(folder, "drive"), os.path.join(folder, "out")
    subprocess.run([os.environ["SLAM_SIM"], "--scenario", case.scenario, "--seed", str(case.seed), "--duration",
                    str(duration_s), "--serial-bytes", "--out", drive, "--quiet", *case.options], check=True, timeout=600)
    subprocess.run([os.environ["SLAM_REPLAY"], drive, "--config", os.path.join(ROOT, "config/slamd.yaml"), "--out", out,
                    "--no-map", "--quiet"], check=True, timeout=600)
    return measure(case, drive, out)


def row(outcome):
    case = outcome.case
    reasons = outcome.reasons(case.begin_s or 0.0)
    recovery = "-" if case.end_s is None else f"{outcome.recovery_s():.1f} s"
    during = "-" if case.end_s is None else f"{outcome.worst_m(case.begin_s, case.end_s + 1.0):.3f}"
    return (f"| {case.name} | {', '.join(sorted(outcome.statuses() - {'INITIALISING'}))} | "
            f"{', '.join(sorted(reasons)) or '-'} | {during} | {outcome.errors_m[-1]:.3f} | {recovery} | "
            f"{100.0 * outcome.covered_share():.0f} % |")


def main():
    print("| fault | status | reasons given | worst error during it, m | error at the end, m | TRACKING again after | "
          "poses whose covariance covers the error |\n| --- | --- | --- | --- | --- | --- | --- |")
    for case in CASES.values():
        with tempfile.TemporaryDirectory(prefix="slamd-fault-") as folder:
            print(row(run(case, folder)), flush=True)


if __name__ == "__main__":
    sys.exit(main())
