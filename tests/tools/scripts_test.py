"""tools/check-includes, tools/install-packages and tools/lib/count_tests.py: what they let pass and what they refuse."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tools/lib"))
import count_tests  # noqa: E402  (found through the line above)

HEADER = "#pragma once\n// A thing, not another.\n"


class Folder(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.root = self.temp.name

    def tearDown(self):
        self.temp.cleanup()

    def write(self, path, text, mode=0o644):
        full = os.path.join(self.root, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(full, mode)
        return full


class CheckIncludes(Folder):
    def setUp(self):
        super().setUp()
        subprocess.run(["git", "init", "-q", self.root], check=True)
        for folder in (".", "estimator/types", "estimator/map", "estimator/filter", "drivers/io", "daemon/ring", "daemon/server"):
            self.write(f"{folder}/README.md", "# x\n")
        for path in ("estimator/types/time.hpp", "estimator/map/tree.hpp", "drivers/io/source.hpp", "daemon/ring/ring.hpp"):
            self.write(path, HEADER)

    def check(self):
        run = subprocess.run([sys.executable, os.path.join(ROOT, "tools/check-includes"), "--root", self.root],
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stdout

    def assert_refused(self, words):
        code, text = self.check()
        self.assertEqual(code, 1, text)
        self.assertIn(words, text)
        self.assertEqual(len(text.splitlines()), 1, text)

    def test_includes_down_the_table_pass(self):
        self.write("estimator/filter/f.cpp", '#include "estimator/map/tree.hpp"\n#include "estimator/types/time.hpp"\n')
        self.write("daemon/server/s.cpp", '#include "daemon/ring/ring.hpp"\n')
        self.assertEqual(self.check(), (0, "check-includes: clean\n"))

    def test_a_copy_without_git_is_checked_all_the_same(self):
        shutil.rmtree(os.path.join(self.root, ".git"))
        self.write("build/dev/generated.hpp", "int x;\n")
        self.write("estimator/map/m.cpp", '#include "drivers/io/source.hpp"\n')
        self.assert_refused('estimator/map may not include "drivers/io/source.hpp"')

    def test_include_up_the_table_fails(self):
        self.write("estimator/map/m.cpp", '\n#include "drivers/io/source.hpp"\n')
        self.assert_refused('estimator/map/m.cpp:2: estimator/map may not include "drivers/io/source.hpp"')

    def test_include_of_a_sibling_fails(self):
        self.write("estimator/filter/f.hpp", HEADER)
        self.write("estimator/map/m.cpp", '#include "estimator/filter/f.hpp"\n')
        self.assert_refused('estimator/map may not include "estimator/filter/f.hpp"')

    def test_include_that_does_not_start_at_the_root_fails(self):
        self.write("estimator/map/m.cpp", '#include "tree.hpp"\n')
        self.assert_refused("is no file of the project")

    def test_folder_without_a_rule_fails(self):
        self.write("attic/README.md", "# x\n")
        self.write("attic/a.cpp", '#include "estimator/types/time.hpp"\n')
        self.assert_refused("no row of tools/check-includes")

    def test_folder_without_readme_fails(self):
        self.write("estimator/math/m.cpp", "int x();\n")
        self.assert_refused("estimator/math: has no README.md")

    def test_header_without_its_sentence_fails(self):
        self.write("estimator/map/n.hpp", "#pragma once\nint x();\n")
        self.assert_refused("estimator/map/n.hpp:1: a header begins with")

    def test_long_file_fails(self):
        self.write("estimator/map/m.cpp", "int x();\n" * 401)
        self.assert_refused("estimator/map/m.cpp: 401 lines")

    def test_long_function_fails(self):
        self.write("estimator/map/m.cpp", "int f() {\n" + "  g();\n" * 59 + "}\n")
        self.assert_refused("function f has 61 lines")
        self.write("estimator/map/m.cpp", "int f() {\n" + "  g();\n" * 58 + "}\n")
        self.assertEqual(self.check()[0], 0)


class InstallPackages(Folder):
    """With stand-ins for dpkg-query, apt-get, id and sudo that write down how they were called."""

    def setUp(self):
        super().setUp()
        self.calls = os.path.join(self.root, "calls")
        self.list = self.write("packages.txt", "# a comment\nhave-it  # why\n\nmissing-one\nmissing-two # why\n")
        self.stand_in("dpkg-query", 'case "$*" in *have-it*) echo -n installed ;; *) exit 1 ;; esac')
        self.stand_in("apt-get", f'echo "apt-get $*" >>{self.calls}; case "$*" in *--simulate*) exit 0 ;; esac')
        self.stand_in("id", "echo 0")
        self.stand_in("sudo", f'echo "sudo $*" >>{self.calls}; [ "$1" = -v ] || "$@"')

    def stand_in(self, name, body):
        self.write(f"bin/{name}", f"#!/bin/bash\n{body}\n", 0o755)

    def run_script(self, *options):
        path = os.path.join(self.root, "bin") + ":" + os.environ["PATH"]
        run = subprocess.run([os.path.join(ROOT, "tools/install-packages"), "--file", self.list, *options],
                             capture_output=True, text=True, check=False, env={**os.environ, "PATH": path})
        return run.returncode, run.stdout + run.stderr

    def called(self):
        if not os.path.exists(self.calls):
            return []
        with open(self.calls, encoding="utf-8") as file:
            return file.read().splitlines()

    def test_list_names_each_package_without_comments(self):
        self.assertEqual(self.run_script("--list"), (0, "have-it\nmissing-one\nmissing-two\n"))

    def test_check_only_says_what_is_missing(self):
        self.assertEqual(self.run_script("--check"), (1, "packages missing: missing-one missing-two\n"))
        self.assertEqual(self.called(), [])

    def test_root_installs_only_what_is_missing_without_recommends(self):
        code, _ = self.run_script()
        self.assertEqual(code, 0)
        install = self.called()[-1]
        self.assertIn("install -y --no-install-recommends missing-one missing-two", install)
        self.assertNotIn("have-it", install)
        self.assertFalse(any("update" in call for call in self.called()))

    def test_updates_the_lists_when_apt_does_not_know_a_package(self):
        self.stand_in("apt-get", f'echo "apt-get $*" >>{self.calls}; case "$*" in *--simulate*) exit 100 ;; esac')
        self.assertEqual(self.run_script()[0], 0)
        self.assertTrue(self.called()[1].endswith(" update"))

    def test_other_users_go_through_sudo(self):
        self.stand_in("id", "echo 1000")
        self.assertEqual(self.run_script()[0], 0)
        self.assertEqual(self.called()[0], "sudo -v")
        self.assertTrue(self.called()[-2].startswith("sudo env DEBIAN_FRONTEND=noninteractive apt-get"))

    def test_without_root_it_says_the_command_to_run(self):
        self.stand_in("id", "echo 1000")
        self.stand_in("sudo", "exit 1")
        code, text = self.run_script()
        self.assertEqual(code, 1)
        self.assertIn("apt-get update && apt-get install --no-install-recommends missing-one missing-two", text)
        self.assertEqual(self.called(), [])

    def test_failing_apt_fails_with_advice(self):
        self.stand_in("apt-get", "exit 100")
        code, text = self.run_script()
        self.assertEqual(code, 1)
        self.assertIn("could not install: missing-one missing-two", text)

    def test_nothing_missing_calls_nothing(self):
        self.stand_in("dpkg-query", "echo -n installed")
        self.assertEqual(self.run_script(), (0, "packages: all installed\n"))
        self.assertEqual(self.called(), [])

    def test_a_package_that_another_one_contains_is_not_missing(self):
        self.stand_in("dpkg-query", """case "$*" in *have-it*) echo -n installed ;; *Provides*)
          echo "installed,other, missing-two (= 1)"; echo "not-installed,missing-one" ;; *) exit 1 ;; esac""")
        self.assertEqual(self.run_script("--check"), (1, "packages missing: missing-one\n"))

    def test_unknown_option_and_unreadable_list(self):
        self.assertEqual(self.run_script("--bogus")[0], 2)
        self.list = "/nonexistent"
        self.assertEqual(self.run_script()[0], 2)


class CountTests(Folder):
    def count(self, ctest, **reports):
        cases = "".join(f'<testcase name="{name}" status="{status}"/>' for name, status in ctest.items())
        junit = self.write("ctest.xml", f"<testsuite>{cases}</testsuite>")
        for name, body in reports.items():
            self.write(f"gtest/{name}.xml", body)
        return count_tests.count(junit, os.path.join(self.root, "gtest"))

    def test_cases_of_binaries_are_summed(self):
        report = ('<testsuites><testsuite><testcase status="run" result="completed"/>'
                  '<testcase status="run" result="skipped"><skipped/></testcase>'
                  '<testcase status="run" result="completed"><failure/></testcase>'
                  '<testcase status="notrun"/></testsuite></testsuites>')
        self.assertEqual(self.count({"a": "fail"}, a=report), [1, 1, 1])

    def test_a_binary_that_died_counts_as_one_failure(self):
        self.assertEqual(self.count({"a": "fail", "b": "run"}), [1, 1, 0])
        self.assertEqual(self.count({"a": "fail"}, a="<testsuites><test"), [0, 1, 0])

    def test_cases_of_python_scripts_are_summed(self):
        junit = self.write("ctest.xml", '<testsuite><testcase name="a" status="fail"><system-out>..F\n----\nRan 9 tests in 1.2s'
                                        '\n\nFAILED (failures=1, errors=2, skipped=1)</system-out></testcase></testsuite>')
        self.assertEqual(count_tests.count(junit, os.path.join(self.root, "gtest")), [5, 3, 1])

    def test_cases_of_node_are_summed(self):
        junit = self.write("ctest.xml", '<testsuite><testcase name="a" status="fail"><system-out># tests 7\n# suites 0\n# pass 4\n'
                                        '# fail 1\n# cancelled 1\n# skipped 1\n</system-out></testcase></testsuite>')
        self.assertEqual(count_tests.count(junit, os.path.join(self.root, "gtest")), [4, 2, 1])

    def test_a_failure_after_passed_cases_is_not_lost(self):
        report = '<testsuites><testsuite><testcase status="run" result="completed"/></testsuite></testsuites>'
        self.assertEqual(self.count({"a": "fail"}, a=report), [1, 1, 0])


class TestStages(Folder):
    """tools/test in a copy of its own, with stand-ins for cmake and ctest."""

    def setUp(self):
        super().setUp()
        shutil.copytree(os.path.join(ROOT, "tools"), os.path.join(self.root, "tools"),
                        ignore=lambda folder, names: [n for n in names if n.startswith("slam")])
        self.write("tools/check-includes", "print('clean')\n")
        self.stand_in("cmake", "exit 0")
        self.ctest_gives('<testcase name="a_test" status="run"/><testcase name="b_test" status="run"/>', 0)

    def stand_in(self, name, body):
        self.write(f"bin/{name}", f"#!/bin/bash\n{body}\n", 0o755)

    def ctest_gives(self, cases, code):
        self.stand_in("ctest", f"""
while [ $# -gt 0 ]; do [ "$1" = --output-junit ] && echo '<testsuite>{cases}</testsuite>' >"$2"; shift; done
exit {code}""")

    def run_stages(self, *options):
        path = os.path.join(self.root, "bin") + ":" + os.environ["PATH"]
        run = subprocess.run([os.path.join(self.root, "tools/test"), "--no-install", *options], capture_output=True,
                             text=True, check=False, env={**os.environ, "PATH": path})
        return run.returncode, run.stdout.splitlines()

    def test_all_well_ends_with_the_sum_of_cases(self):
        code, lines = self.run_stages("--fast")
        self.assertEqual((code, lines[-1]), (0, "4 passed, 0 failed"), lines)
        self.assertEqual([line.split()[0] for line in lines[:3]], ["includes", "build", "unit"])

    def test_a_failing_case_fails_the_run_but_not_the_stages_after_it(self):
        self.ctest_gives('<testcase name="a_test" status="run"/><testcase name="b_test" status="fail"/>', 8)
        code, lines = self.run_stages("--stage", "unit", "--stage", "includes")
        self.assertEqual((code, lines[-1]), (1, "2 passed, 1 failed"), lines)

    def test_without_a_build_nothing_is_run(self):
        self.stand_in("cmake", "echo broken.cpp:3: error; exit 1")
        code, lines = self.run_stages("--fast")
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"), lines)
        self.assertIn("broken.cpp:3: error", lines)
        self.assertFalse(any(line.startswith("unit") for line in lines))

    def test_a_wrong_include_is_a_failure(self):
        self.write("tools/check-includes", "print('a.cpp:1: may not'); raise SystemExit(1)\n")
        code, lines = self.run_stages("--stage", "includes")
        self.assertEqual((code, lines[-1]), (1, "0 passed, 1 failed"), lines)
        self.assertIn("a.cpp:1: may not", lines)

    def test_ctest_that_dies_without_a_report_is_a_failure(self):
        self.stand_in("ctest", "exit 9")
        code, lines = self.run_stages("--stage", "unit")
        self.assertEqual((code, lines[-1]), (1, "0 passed, 1 failed"), lines)


class TestOptions(unittest.TestCase):
    def run_test(self, *options):
        return subprocess.run([os.path.join(ROOT, "tools/test"), *options], capture_output=True, text=True, check=False)

    def test_help_names_every_stage(self):
        run = self.run_test("--help")
        self.assertEqual(run.returncode, 0)
        for stage in ("includes", "build", "unit", "firmware", "replay", "e2e", "asan", "tsan", "fuzz"):
            self.assertIn(f"\n  {stage} ", run.stdout)

    def test_wrong_options_end_with_2(self):
        for options in (["--stage"], ["--stage", "nothing"], ["--fuzz-seconds", "x"], ["--bogus"]):
            self.assertEqual(self.run_test(*options).returncode, 2, options)


if __name__ == "__main__":
    unittest.main()
