"""Simulated drives with wrong candidates among the loop closer's own, judged by the truth. As a program it prints a table:

    SLAM_SIM=... SLAM_REPLAY=... PYTHONPATH=tests/support python3 closure_drives.py parking 200 1 2 3    # scenario, metres, seeds
"""

import csv
import dataclasses
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import rigid

FALSE_M, FALSE_RAD = 0.5, math.radians(3.0)  # a closure farther off the truth is false
ACCEPTED = 7
TRUE_PLACE_M = 10.0


@dataclasses.dataclass
class Outcome:
    candidates: int = 0       # all that the stages judged
    wrong: int = 0            # of them: of places farther apart than TRUE_PLACE_M
    stages: dict = dataclasses.field(default_factory=dict)  # at which stage the wrong ones ended: count
    accepted: int = 0
    false: int = 0            # accepted, and wrong by the truth
    true: int = 0             # candidates of the same place
    true_accepted: int = 0
    worst_m: float = 0.0      # of the accepted

    @property
    def recall(self):
        return self.true_accepted / self.true if self.true else math.nan


def judge(drive, out):
    truth = rigid.Truth(drive / "truth.tum")
    with open(out / "keyframes.csv", encoding="ascii") as file:
        stamps = [float(line.split(",")[0]) for line in file if line[0].isdigit()]
    outcome = Outcome()
    with open(out / "closures.csv", encoding="ascii") as file:
        for row in csv.DictReader(file):
            poses = [truth.at(stamps[int(row[end])]) for end in ("from", "to")]
            told = (tuple(float(row[k]) for k in ("x_m", "y_m", "z_m")), tuple(float(row[k]) for k in ("qx", "qy", "qz", "qw")))
            error_m, error_rad = rigid.errors(rigid.relative(*poses), told)
            accepted = int(row["ended_at"]) == ACCEPTED
            outcome.candidates += 1
            outcome.accepted += accepted
            if accepted:
                outcome.worst_m = max(outcome.worst_m, error_m)
                outcome.false += error_m > FALSE_M or error_rad > FALSE_RAD
            if math.dist(poses[0][0], poses[1][0]) > TRUE_PLACE_M:
                outcome.wrong += 1
                outcome.stages[row["ended_at"]] = outcome.stages.get(row["ended_at"], 0) + 1
            else:
                outcome.true += 1
                outcome.true_accepted += accepted
    return outcome


def run(scenario, length_m, seed, folder, wrong_candidates=0.5, faults=()):
    """Makes the drive in `folder`, replays it with that share of wrong candidates, judges its closures."""
    drive, out = pathlib.Path(folder) / "drive", pathlib.Path(folder) / "out"
    length = ["--length", str(length_m)] if length_m > 0 else []
    fault = [word for f in faults for word in ("--fault", f)]
    subprocess.run([os.environ["SLAM_SIM"], "--scenario", scenario, "--seed", str(seed), *length, *fault, "--quiet", "--out", drive],
                   check=True, timeout=600)
    subprocess.run([os.environ["SLAM_REPLAY"], drive, "--quiet", "--no-gps", "--wrong-candidates", str(wrong_candidates),
                    "--out", out], check=True, timeout=600)
    return judge(drive, out)


def main():
    scenario, length_m, *seeds = sys.argv[1:]
    print("| drive | candidates | of other places | ended at stage | accepted | false | worst m | recall of the same place |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for seed in seeds:
        with tempfile.TemporaryDirectory(prefix="slamd-closures-") as folder:
            o = run(scenario, float(length_m), int(seed), folder)
        print(f"| {scenario} {seed} | {o.candidates} | {o.wrong} | {o.stages} | {o.accepted} | {o.false} | {o.worst_m:.3f} | "
              f"{o.recall:.2f} ({o.true_accepted}/{o.true}) |", flush=True)


if __name__ == "__main__":
    main()
