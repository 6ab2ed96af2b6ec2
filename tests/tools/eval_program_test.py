"""slam-eval as a program: exit codes, table, JSON, PNG and what it says about bad input. SLAM_EVAL is its path."""
import json
import math
import os
import struct
import subprocess
import tempfile
import unittest


def tum_lines(count, offset_s=0.0, shift=(0.0, 0.0, 0.0)):
    """A drive on a circle of 10 m."""
    rows = []
    for i in range(count):
        a = 0.02 * i
        x, y, z = 10.0 * math.cos(a) + shift[0], 10.0 * math.sin(a) + shift[1], shift[2]
        rows.append(f"{offset_s + 0.1 * i:.6f} {x} {y} {z} 0 0 {math.sin(a / 2)} {math.cos(a / 2)}")
    return "\n".join(rows) + "\n"


class SlamEval(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.truth = self.write("truth.tum", tum_lines(200))
        self.shifted = self.write("shifted.tum", tum_lines(200, shift=(3.0, 0.0, 4.0)))

    def tearDown(self):
        self.temp.cleanup()

    def path(self, name):
        return os.path.join(self.temp.name, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def run_eval(self, *arguments):
        run = subprocess.run([os.environ["SLAM_EVAL"], *arguments], capture_output=True, text=True, check=False, timeout=60)
        return run.returncode, run.stdout, run.stderr

    def results(self, *arguments):
        code, _, error = self.run_eval(*arguments, "--json", self.path("out.json"))
        self.assertEqual((code, error), (0, ""))
        with open(self.path("out.json"), encoding="utf-8") as file:
            return json.load(file)

    def test_ape_aligns_unless_told_otherwise(self):
        aligned = self.results("ape", self.truth, self.shifted)
        self.assertEqual((aligned["alignment"], aligned["matched_poses"]), ("se3_umeyama", 200))
        self.assertLess(aligned["results"]["translation_part"]["rmse"], 1e-9)
        raw = self.results("ape", self.truth, self.shifted, "--no-align")
        self.assertAlmostEqual(raw["results"]["translation_part"]["rmse"], 5.0)

    def test_rpe_by_metres_says_its_pairs(self):
        out = self.results("rpe", self.truth, self.shifted, "-d", "1", "-u", "m")
        self.assertEqual(out["rpe"], {"delta": 1.0, "unit": "m", "all_pairs": False})
        self.assertEqual(out["results"]["translation_part"]["count"], 32)
        self.assertLess(out["results"]["translation_part"]["max"], 1e-9)

    def test_table_has_a_line_for_each_relation(self):
        code, text, _ = self.run_eval("ape", self.truth, self.shifted, "-r", "trans_part", "angle_deg")
        self.assertEqual(code, 0)
        self.assertIn("translation_part [m]", text)
        self.assertIn("rotation_angle_deg [deg]", text)
        self.assertNotIn("full_transformation", text)

    def test_plots_are_png(self):
        for command in ("ape", "rpe"):
            code, _, error = self.run_eval(command, self.truth, self.shifted, "--plot", self.path("p.png"))
            self.assertEqual((code, error), (0, ""))
            with open(self.path("p.png"), "rb") as file:
                head = file.read(24)
            self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(struct.unpack(">II", head[16:24]), (1700, 760))

    def test_picture_with_truth(self):
        points = "".join(f"{i % 50} {i // 50} 0 {i % 256}\n" for i in range(2500))
        cloud = self.write("map.pcd", "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
                                      "WIDTH 2500\nHEIGHT 1\nPOINTS 2500\nDATA ascii\n" + points)
        code, text, error = self.run_eval("picture", "--map", cloud, "--trajectory", self.shifted, "--truth", self.truth,
                                          "--out", self.path("m.png"), "--width", "640")
        self.assertEqual((code, error), (0, ""))
        self.assertIn("m.png", text)
        self.assertGreater(os.path.getsize(self.path("m.png")), 5000)

    def assert_refused(self, words, *arguments):
        code, _, error = self.run_eval(*arguments)
        self.assertEqual(code, 1)
        self.assertIn(words, error)
        self.assertEqual(len(error.splitlines()), 1)

    def test_bad_input_is_refused_with_file_line_and_reason(self):
        bad = self.write("bad.tum", "1 2 3\n")
        self.assert_refused("bad.tum:1: expected 8 columns, found 3", "ape", self.truth, bad)
        self.assert_refused("absent.tum: cannot be opened", "ape", self.truth, self.path("absent.tum"))
        self.assert_refused("bad.tum: is no PCD file", "picture", "--map", bad, "--out", self.path("m.png"))
        self.assert_refused("cannot be written", "ape", self.truth, self.shifted, "--json", "/nonexistent/x.json")

    def test_stamps_that_do_not_overlap_are_explained_and_the_advice_works(self):
        late = self.write("late.tum", tum_lines(200, offset_s=500.0))
        self.assert_refused("--time-offset -500.000", "ape", self.truth, late)
        self.assertEqual(self.run_eval("ape", self.truth, late, "--time-offset", "-500")[0], 0)

    def test_pairs_longer_than_the_drive_are_explained(self):
        self.assert_refused("take a smaller --delta", "rpe", self.truth, self.shifted, "-d", "1000", "-u", "m")

    def test_wrong_command_lines_end_with_2(self):
        for arguments in ([], ["ape"], ["ape", self.truth, self.shifted, "--bogus"], ["rpe", self.truth, self.shifted, "-u", "x"],
                          ["ape", self.truth, self.shifted, "--no-align", "--align"]):
            self.assertEqual(self.run_eval(*arguments)[0], 2, arguments)


if __name__ == "__main__":
    unittest.main()
