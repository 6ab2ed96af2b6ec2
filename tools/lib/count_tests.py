"""Sums the test cases of one ctest run: `count_tests.py JUNIT GTEST_DIR` prints `passed failed skipped`.

A GoogleTest binary counts its cases from GTEST_DIR/NAME.xml, a Python unittest script and a node test those that they
printed; any other ctest test, and a program that died before it said its count, counts as one case.
"""
import glob
import os
import re
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


def unittest_cases(output):
    """(passed, failed, skipped) of what Python's unittest printed; None when it printed no summary."""
    ran = re.findall(r"^Ran (\d+) tests? in ", output, re.MULTILINE)
    if not ran:
        return None
    number = {kind: int(count) for kind, count in re.findall(r"(failures|errors|skipped)=(\d+)", output)}
    failed, skipped = number.get("failures", 0) + number.get("errors", 0), number.get("skipped", 0)
    return max(0, int(ran[-1]) - failed - skipped), failed, skipped


def node_cases(output):
    """(passed, failed, skipped) of node's test runner, TAP reporter; None when it printed no summary."""
    number = {kind: int(count) for kind, count in re.findall(r"^# (pass|fail|cancelled|skipped) (\d+)$", output, re.MULTILINE)}
    if "pass" not in number:
        return None
    return number["pass"], number.get("fail", 0) + number.get("cancelled", 0), number.get("skipped", 0)


def ctest_results(path):
    """[(name, "run" | "fail" | "disabled" | ..., output)] of ctest's JUnit file."""
    return [(case.get("name"), case.get("status"), case.findtext("system-out") or "")
            for case in ElementTree.parse(path).getroot().iter("testcase")]


def count(junit_path, gtest_dir):
    totals = [0, 0, 0]

    def add(cases):
        totals[:] = [a + b for a, b in zip(totals, cases)]

    reports = {os.path.basename(path)[:-4]: gtest_cases(path) for path in glob.glob(os.path.join(gtest_dir, "*.xml"))}
    for name, status, output in ctest_results(junit_path):
        cases = reports.pop(name, None) or unittest_cases(output) or node_cases(output)
        ok = status == "run"
        if cases is None:
            cases = (1, 0, 0) if ok else ((0, 0, 1) if status in ("disabled", "notrun") else (0, 1, 0))
        elif not ok and cases[1] == 0:
            add((0, 1, 0))  # all cases passed, and yet the program failed: a sanitizer's report or a crash at exit
        add(cases)
    for cases in reports.values():  # a binary that several ctest tests run under other names
        add(cases or (0, 0, 0))
    return totals


if __name__ == "__main__":
    print(*count(sys.argv[1], sys.argv[2]))
