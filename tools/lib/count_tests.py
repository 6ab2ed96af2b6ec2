"""Sums the test cases of one ctest run: `count_tests.py JUNIT GTEST_DIR` prints `passed failed skipped`.

A GoogleTest binary counts its cases from GTEST_DIR/NAME.xml; any other ctest test, and a binary that died before it
wrote its file, counts as one case.
"""
import glob
import os
import sys
import xml.etree.ElementTree as ElementTree


def gtest_cases(path):
    """(passed, failed, skipped) of one GoogleTest report; None when it cannot be read."""
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError):
        return None
    passed = failed = skipped = 0
    for case in root.iter("testcase"):
        if case.get("status") == "notrun":
            continue
        if case.find("failure") is not None or case.find("error") is not None:
            failed += 1
        elif case.get("result") == "skipped" or case.find("skipped") is not None:
            skipped += 1
        else:
            passed += 1
    return passed, failed, skipped


def ctest_results(path):
    """{name: "run" | "fail" | "disabled" | ...} of ctest's JUnit file."""
    return {case.get("name"): case.get("status") for case in ElementTree.parse(path).getroot().iter("testcase")}


def count(junit_path, gtest_dir):
    totals = [0, 0, 0]
    reports = {os.path.basename(path)[:-4]: gtest_cases(path) for path in glob.glob(os.path.join(gtest_dir, "*.xml"))}
    for cases in reports.values():
        if cases:
            totals = [a + b for a, b in zip(totals, cases)]
    for name, status in ctest_results(junit_path).items():
        cases = reports.get(name)
        ok = status == "run"
        if cases is None:
            totals[0 if ok else (2 if status in ("disabled", "notrun") else 1)] += 1
        elif not ok and cases[1] == 0:
            totals[1] += 1  # all cases passed, and yet the program failed: a sanitizer's report or a crash at exit
    return totals


if __name__ == "__main__":
    print(*count(sys.argv[1], sys.argv[2]))
