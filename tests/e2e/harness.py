"""Runs the real slamd and slam-sim on loopback, ptys and a socket in a temporary folder. Holds no test."""

import contextlib
import functools
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "support"))  # rigid, waiting

from waiting import first_value  # noqa: E402

SLAMD = os.environ.get("SLAMD", "slamd")
SLAM_SIM = os.environ.get("SLAM_SIM", "slam-sim")

ATTEMPTS = 3  # of what a busy machine may spoil
SENSORS_PRIORITY = 5
PUNCTUAL_MS = 15.0  # the daemon calls 25 ms between two IMU samples a gap


def in_real_time(test):
    """Repeats a test that failed while its sensors sent late, as a busy machine makes them, and skips it when they did so in
    every attempt. A failure with punctual sensors stands at once."""

    @functools.wraps(test)
    def attempts(self):
        for _ in range(ATTEMPTS):
            try:
                return test(self)
            except AssertionError as failure:
                late_ms = self.latest_ms()
                print(f"failed, the sensors were {late_ms:.1f} ms late: {str(failure)[:500]}", flush=True)
                if late_ms < PUNCTUAL_MS:
                    raise
            self.tearDown()
            self.setUp()
        return self.skipTest(f"no real time on this machine: the sensors were {late_ms:.0f} ms late, {ATTEMPTS} times")

    return attempts


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def hurry():
    """Run by the children that are sensors before they start: those have processors of their own in a vehicle."""
    with contextlib.suppress(PermissionError):
        os.nice(-15)


def hurry_before_all():
    """Likewise beside other work that would make them late: in real time, below all of the daemon's own threads of that kind."""
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(SENSORS_PRIORITY))
    except PermissionError:
        hurry()


class Process:
    """A child with its output in a file; ended by stop() at the latest."""

    def __init__(self, arguments, log_path, prepare=None, fds=()):
        self.log_path = log_path
        with open(log_path, "wb") as log:
            self.child = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=log, stderr=log, preexec_fn=prepare,
                                          pass_fds=fds)

    def output(self):
        with open(self.log_path, encoding="utf-8", errors="replace") as log:
            return log.read()

    def running(self):
        return self.child.poll() is None

    def send(self, signal_number):
        self.child.send_signal(signal_number)

    def wait(self, timeout_s):
        return self.child.wait(timeout_s)

    def latest_ms(self):
        """Ends it; by how much the latest of what it sent was late, 0 when it does not say."""
        self.send(signal.SIGTERM)
        try:
            self.wait(30.0)
        except subprocess.TimeoutExpired:
            return 0.0
        found = re.findall(r"latest (?:packet )?([0-9.]+) ms late", self.output())
        return float(found[-1]) if found else 0.0

    def stop(self):
        if self.running():
            self.child.kill()
        self.child.wait()


class Client:
    """JSON-RPC 2.0 over the daemon's socket, one object a line."""

    def __init__(self, path, timeout_s=30.0):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(timeout_s)
        try:
            self.socket.connect(path)
        except OSError:
            self.socket.close()
            raise
        self.lines = self.socket.makefile("rb")
        self.next_id = 0
        self.notifications = []

    def call(self, method, **params):
        self.next_id += 1
        request = {"jsonrpc": "2.0", "id": self.next_id, "method": method, "params": params}
        self.socket.sendall(json.dumps(request).encode() + b"\n")
        while True:
            answer = json.loads(self.lines.readline())
            if answer.get("id") == self.next_id:
                return answer
            if "method" in answer:
                self.notifications.append(answer)

    def next_notification(self):
        while not self.notifications:
            message = json.loads(self.lines.readline())
            if "method" in message:
                self.notifications.append(message)
        return self.notifications.pop(0)

    def pose(self):
        """The result of get_pose; None as long as there is none."""
        return self.call("get_pose").get("result")

    def status(self):
        return self.call("get_status")["result"]

    def close(self):
        self.lines.close()
        self.socket.close()


class EndToEndTest(unittest.TestCase):
    """A temporary folder, and one daemon and one simulator in it at most at a time."""

    prepare_sensor = staticmethod(hurry)

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="slamd-e2e-")
        self.port = free_udp_port()
        self.position_port = free_udp_port()
        self.processes = []
        self.client = None

    def tearDown(self):
        if self.client:
            self.client.close()
        for process in reversed(self.processes):
            process.stop()
        shutil.rmtree(self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, name, arguments, prepare=None, fds=()):
        process = Process(arguments, self.path(f"{name}-{len(self.processes)}.log"), prepare, fds)
        self.processes.append(process)
        return process

    def latest_ms(self):
        return max((process.latest_ms() for process in self.processes), default=0.0)

    def daemon_arguments(self):
        settings = {
            "lidar.bind_address": "127.0.0.1",
            "lidar.port": self.port,
            "lidar.position_port": self.position_port,
            "imu.device": self.path("imu"),
            "gnss.device": self.path("gnss"),
            "server.socket": self.path("slamd.sock"),
            "server.save_dir": self.folder,
        }
        arguments = [SLAMD]
        for key, value in settings.items():
            arguments += ["--set", f"{key}={value}"]
        return arguments

    def start_daemon(self, *extra):
        daemon = self.start("slamd", [*self.daemon_arguments(), *extra])
        self.client = self.await_value("the socket", lambda: self.connect(daemon), 60.0)
        return daemon

    def connect(self, daemon):
        if not daemon.running():
            self.fail(f"slamd ended: {daemon.output()}")
        try:
            return Client(self.path("slamd.sock"))
        except OSError:
            return None

    def start_simulator(self, *extra):
        return self.start("slam-sim", [SLAM_SIM, "--live", "--imu-pty", self.path("imu"), "--gps-pty", self.path("gnss"),
                                       "--lidar-port", str(self.port), "--position-port", str(self.position_port),
                                       "--truth", self.path("truth.tum"), *extra], self.prepare_sensor)

    def await_value(self, what, attempt, timeout_s):
        """Asks until attempt() gives something true; fails after timeout_s with everybody's output."""
        value = first_value(attempt, timeout_s)
        if value:
            return value
        outputs = "\n".join(process.output()[-3000:] for process in self.processes)
        return self.fail(f"waited {timeout_s} s for {what}\n{outputs}")

    def await_pose(self, what, accept, timeout_s=60.0):
        def attempt():
            pose = self.client.pose()
            return pose if pose and accept(pose) else None

        return self.await_value(what, attempt, timeout_s)

    def assert_stops_cleanly(self, daemon):
        """Its own bound is a second; a machine that is busy otherwise is granted thirty."""
        begin = time.monotonic()
        daemon.send(signal.SIGTERM)
        self.assertEqual(daemon.wait(30.0), 0, daemon.output())
        print(f"stopped after {time.monotonic() - begin:.3f} s", flush=True)
