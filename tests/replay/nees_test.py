"""Is the covariance true? Simulated drives of many kinds and seeds through slam-replay: the squared position error at the end
of each that starts at rest, normalised by the covariance of that pose, has on average one a degree of freedom or less."""

import tempfile
import unittest

import fault_drives

SCENARIOS = ("campus", "rough", "urban", "crowd", "parking")
SEEDS = (11, 12)
DEGREES = 3
# 97.5 % of chi-squared with 3 * 10 degrees of freedom, a degree: beyond, the covariance is too small.
UPPER = 46.98 / 30.0
# The covariance is wider than it need be (README.md); below this it would say nothing any more.
LOWER = 0.03


class Nees(unittest.TestCase):
    def test_the_error_at_the_end_is_what_the_covariance_says(self):
        normalised = {}
        for scenario in SCENARIOS:
            for seed in SEEDS:
                case = fault_drives.Case(f"{scenario} {seed}", (), scenario=scenario, seed=seed)
                with tempfile.TemporaryDirectory(prefix="slamd-nees-") as folder:
                    outcome = fault_drives.run(case, folder, duration_s=20.0)
                self.assertGreater(len(outcome.stamps), 120, case.name)
                normalised[case.name] = outcome.squares[-1] / DEGREES
        print({name: round(value, 2) for name, value in normalised.items()})
        mean = sum(normalised.values()) / len(normalised)
        self.assertLess(mean, UPPER, normalised)
        self.assertGreater(mean, LOWER, normalised)


if __name__ == "__main__":
    unittest.main()
