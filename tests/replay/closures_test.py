"""No closure is false where places repeat themselves and half of the candidates are wrong: real keyframes of a parking house."""

import tempfile
import unittest

import closure_drives


class WrongCandidates(unittest.TestCase):
    def test_none_is_accepted_in_a_parking_house(self):
        with tempfile.TemporaryDirectory(prefix="slamd-closures-") as folder:
            outcome = closure_drives.run("parking", 120.0, 1, folder, wrong_candidates=1.0)
        self.assertGreater(outcome.wrong, 5, outcome)
        self.assertEqual(outcome.false, 0, outcome)


if __name__ == "__main__":
    unittest.main()
