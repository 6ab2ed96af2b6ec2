"""The flow of tools/demo with stand-ins for the programs: what it starts, shows, saves and ends, and how it fails."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tools/lib"))
import demo_report  # noqa: E402  (found through the line above)
import programs  # noqa: E402

# Every stand-in writes its arguments and its process id to the folder it lies in.
PREAMBLE = """#!/usr/bin/env python3
import json, os, signal, socket, sys, time
here, me = os.path.dirname(os.path.abspath(__file__)), os.path.basename(__file__)
with open(os.path.join(here, me + ".calls"), "a") as file:
    file.write(json.dumps([os.getpid(), sys.argv[1:]]) + "\\n")
def option(name):
    return sys.argv[sys.argv.index(name) + 1]
"""
SIMULATOR = """
for name in ("--imu-pty", "--gps-pty"):
    open(option(name), "w").close()
print("campus [###] 50 %  1.5/3.0 s  1.0x real time", flush=True)
time.sleep(float(os.environ.get("DRIVE_SECONDS", "1.2")))
open(option("--truth"), "w").write("0 0 0 0 0 0 0 1\\n")
"""
DAEMON = """
settings = dict(argument.split("=", 1) for argument in sys.argv if "=" in argument)
server = socket.socket(socket.AF_UNIX)
server.bind(settings["server.socket"])
server.listen()
signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
source = {"rate_hz": 753.9, "received": 10, "lost": 1, "rejected": {"crc": 2}}
status = {"pose": {"status": "TRACKING", "reasons": []}, "map": {"keyframes": 4, "points": 99},
          "health": {"sources": {"lidar": source}, "rings": {"lidar": {"dropped": 0}}, "memory": {"peak_bytes": 5e7},
                     "stages_ms": {"scan": {"count": 3, "p50": 4.0, "p99": 9.0, "max": 11.0}}}}
pose = {"T_map_base": {"translation_m": [1.0, 2.0, 0.5]}, "velocity_mps": [3.0, 4.0, 0.0]}
while True:
    link, _ = server.accept()
    request = json.loads(link.makefile().readline())
    result = status if request["method"] == "get_status" else pose
    link.sendall(json.dumps({"jsonrpc": "2.0", "id": request["id"], "result": result}).encode() + b"\\n")
    link.close()
"""
SAVER = 'open(sys.argv[-1], "w").write("saved")\n'
EVALUATOR = """
numbers = {"rmse": 0.021, "median": 0.02, "max": 0.05, "count": 77}
if "--json" in sys.argv:
    json.dump({"results": {"translation_part": numbers, "rotation_angle_deg": numbers}}, open(option("--json"), "w"))
for name in ("--plot", "--out"):
    if name in sys.argv:
        open(option(name), "w").close()
"""
REPLAY = """
out = option("--out")
open(out + "/odom.tum", "w").close()
open(out + "/map.pcd", "w").close()
report = {"scans": 240, "duration_s": 24.0, "realtime_factor": 15.0, "peak_rss_mb": 80.0,
          "scan_ms": {"p50": 4.0, "p90": 5.0, "p99": 8.0, "p999": 9.0, "max": 9.5},
          "drops": {}, "rejections": {"lidar": {"size": 3, "model": 0}}}
json.dump(report, open(out + "/report.json", "w"))
"""


class Demo(unittest.TestCase):
    def setUp(self):
        self.temp = tempfile.TemporaryDirectory()
        self.bin = os.path.join(self.temp.name, "bin")
        self.out = os.path.join(self.temp.name, "out")
        os.makedirs(self.bin)
        for name, body in (("slam-sim", SIMULATOR), ("slamd", DAEMON), ("slamctl", SAVER), ("slam-eval", EVALUATOR),
                           ("slam-replay", REPLAY)):
            self.stand_in(name, body)

    def tearDown(self):
        self.temp.cleanup()

    def stand_in(self, name, body):
        path = os.path.join(self.bin, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(PREAMBLE + body)
        os.chmod(path, 0o755)

    def calls(self, name):
        with open(os.path.join(self.bin, name + ".calls"), encoding="utf-8") as file:
            return [json.loads(line) for line in file]

    def command(self, *options):
        return [os.path.join(ROOT, "tools/demo"), "--no-install", "--no-build", "--build-dir", self.bin, "--out", self.out,
                *options]

    def run_demo(self, *options):
        return subprocess.run(self.command(*options), capture_output=True, text=True, check=False, timeout=60)

    def assert_ended(self, name):
        pid = self.calls(name)[0][0]
        self.assertFalse(os.path.exists(f"/proc/{pid}"), f"{name} still runs")

    def test_live_drive_ends_with_errors_rates_and_files(self):
        run = self.run_demo("--seconds", "3")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        for words in ("1.5/3.0 s  TRACKING  x 1.00 y 2.00 z 0.50 m  5.0 m/s  lidar 754/s  keyframes 4", "rmse 0.0210 m",
                      "RPE over 1 m position", "lidar 753.9/s", "scan [ms]", "p99 9.000", "peak 50 MB",
                      self.out + "/map.pcd", self.out + "/trajectory.tum", self.out + "/map.png"):
            self.assertIn(words, run.stdout)
        self.assertIn("--duration", self.calls("slam-sim")[0][1])
        settings = [a for a in self.calls("slamd")[0][1] if "=" in a]
        self.assertIn("imu.device=" + self.calls("slam-sim")[0][1][4], settings)
        self.assertEqual([call[1][2:4] for call in self.calls("slamctl")], [["map", "save"], ["trajectory", "save"]])
        self.assert_ended("slamd")

    def test_ctrl_c_ends_every_program(self):
        child = subprocess.Popen(self.command(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                 env={**os.environ, "DRIVE_SECONDS": "60"})
        self.assertIn("slamd runs", child.stdout.readline())
        child.send_signal(signal.SIGINT)
        _, error = child.communicate(timeout=30)
        self.assertEqual(child.returncode, 130)
        self.assertIn("interrupted", error)
        self.assert_ended("slam-sim")
        self.assert_ended("slamd")

    def test_a_daemon_that_dies_fails_with_the_end_of_its_log_and_ends_the_simulator(self):
        self.stand_in("slamd", 'print("config.yaml:3: lidar.prot: unknown key"); sys.exit(2)\n')
        run = self.run_demo()
        self.assertEqual(run.returncode, 1)
        self.assertIn("slamd ended with code 2", run.stderr)
        self.assertIn("unknown key", run.stderr)
        self.assert_ended("slam-sim")

    def test_a_simulator_that_fails_is_reported(self):
        self.stand_in("slam-sim", 'print("no ports"); sys.exit(1)\n')
        run = self.run_demo()
        self.assertEqual(run.returncode, 1)
        self.assertIn("slam-sim ended with code 1:\nno ports", run.stderr)

    def test_a_program_that_is_not_built_is_named(self):
        os.remove(os.path.join(self.bin, "slam-sim"))
        run = self.run_demo()
        self.assertEqual(run.returncode, 1)
        self.assertIn("slam-sim is not in", run.stderr)

    def test_recorded_drive_with_and_without_truth(self):
        drive = os.path.join(self.temp.name, "drive")
        os.makedirs(drive)
        run = self.run_demo("--drive", drive)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertNotIn("Errors against the truth", run.stdout)
        self.assertIn("15.0 times real time", run.stdout)
        self.assertIn("lidar.size 3", run.stdout)
        open(os.path.join(drive, "truth.tum"), "w", encoding="utf-8").close()
        run = self.run_demo("--drive", drive)
        self.assertIn("Errors against the truth", run.stdout)
        self.assertEqual(self.calls("slam-eval")[1][1][0], "ape")

    def test_wrong_options(self):
        self.assertEqual(self.run_demo("--drive", "/nonexistent").returncode, 2)
        self.assertEqual(self.run_demo("--seconds", "0").returncode, 2)
        self.assertEqual(self.run_demo("--bogus").returncode, 2)


class Parts(unittest.TestCase):
    def test_a_busy_port_gives_another_one(self):
        with programs.socket.socket(programs.socket.AF_INET, programs.socket.SOCK_DGRAM) as busy:
            busy.bind(("127.0.0.1", 0))
            port = busy.getsockname()[1]
            self.assertNotIn(programs.free_udp_port(port), (port, 0))

    def test_a_program_that_ignores_the_end_is_killed(self):
        children = programs.Programs("/tmp")
        child = subprocess.Popen([sys.executable, "-c", "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN);"
                                                        "print('on', flush=True); time.sleep(60)"], stdout=subprocess.PIPE)
        child.stdout.readline()
        children.running.append(("stubborn", child))
        begin = time.monotonic()
        self.assertEqual(children.stop("stubborn", patience_s=0.2), -signal.SIGKILL)
        self.assertLess(time.monotonic() - begin, 30)
        child.stdout.close()

    def test_stages_of_a_report_may_be_grouped(self):
        stage = {"p50": 1.0, "p99": 2.0, "max": 3.0}
        rows = demo_report.report_rows({"scans": 1, "duration_s": 1.0, "realtime_factor": 1.0, "peak_rss_mb": 1.0,
                                        "scan_ms": stage, "stage_ms": {"deskew": stage}})
        self.assertIn("deskew [ms]", [label for label, _ in rows])


if __name__ == "__main__":
    unittest.main()
