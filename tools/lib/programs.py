"""Starting, watching and ending the programs of the project; their log files; the socket of slamd."""
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, "build/release")


class Failure(Exception):
    """What the user has to know, in one sentence."""


def find_program(name):
    """The newest build of a program; Failure when there is none."""
    found = []
    for folder, _, files in os.walk(BUILD):
        if name in files and os.access(os.path.join(folder, name), os.X_OK):
            found.append(os.path.join(folder, name))
    if not found:
        raise Failure(f"{name} is not in {BUILD}: build it with `cmake --preset release && cmake --build --preset release`")
    return max(found, key=os.path.getmtime)


def log_end(path, lines=15):
    with open(path, encoding="utf-8", errors="replace") as file:
        return "".join(file.readlines()[-lines:])


class Programs:
    """Children of this process, ended by their id in reverse order when the block is left, whatever the reason."""

    def __init__(self, log_dir):
        self.log_dir = log_dir
        self.running = []  # (name, Popen)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for name, _ in reversed(list(self.running)):
            self.stop(name)

    def log(self, name):
        return os.path.join(self.log_dir, name + ".log")

    def start(self, name, *arguments):
        """In a session of its own, so that Ctrl-C reaches only this script, which then ends them in order."""
        with open(self.log(name), "wb") as log:
            child = subprocess.Popen([find_program(name), *arguments], stdout=log, stderr=subprocess.STDOUT,
                                     stdin=subprocess.DEVNULL, start_new_session=True)
        self.running.append((name, child))
        return child

    def stop(self, name, patience_s=10.0):
        """SIGTERM, and SIGKILL when that is ignored. Returns the exit code."""
        entry = next(entry for entry in self.running if entry[0] == name)
        child = entry[1]
        if child.poll() is None:
            child.send_signal(signal.SIGTERM)
            try:
                child.wait(patience_s)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        self.running.remove(entry)
        return child.returncode

    def check(self, name):
        """Failure with the end of its log when a program that should run has ended."""
        child = next(child for running, child in self.running if running == name)
        if child.poll() is not None:
            raise Failure(f"{name} ended with code {child.returncode}:\n{log_end(self.log(name))}")

    def wait_for(self, name, condition, what, seconds=20.0):
        deadline = time.monotonic() + seconds
        while not condition():
            self.check(name)
            if time.monotonic() > deadline:
                raise Failure(f"{what} did not come within {seconds:.0f} s:\n{log_end(self.log(name))}")
            time.sleep(0.05)


def run(name, *arguments):
    """Runs a program to its end and gives its output; Failure with what it said when it fails."""
    done = subprocess.run([find_program(name), *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failure(f"{name} failed: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout


class Daemon:
    """The socket of slamd: one question at a time."""

    def __init__(self, path):
        self.path = path
        self.ids = 0

    def call(self, method, **params):
        """The result, or None when there is none (yet): no daemon, no pose, a timeout."""
        self.ids += 1
        request = {"jsonrpc": "2.0", "id": self.ids, "method": method, "params": params}
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as link:
                link.settimeout(2.0)
                link.connect(self.path)
                link.sendall(json.dumps(request).encode() + b"\n")
                with link.makefile("rb") as lines:
                    return json.loads(lines.readline()).get("result")
        except (OSError, ValueError):
            return None


def free_udp_port(wanted):
    """`wanted`, or another one when somebody listens there."""
    for port in (wanted, 0):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
                return probe.getsockname()[1]
            except OSError:
                continue
    raise Failure("there is no free UDP port")


class StatusLine:
    """One line that is written over on a terminal, and a line now and then in a log."""

    def __init__(self, every_s=10.0):
        self.terminal = sys.stdout.isatty()
        self.every_s = every_s
        self.last = float("-inf")

    def show(self, text):
        now = time.monotonic()
        if self.terminal:
            width = os.get_terminal_size().columns
            sys.stdout.write("\r" + text[:width - 1].ljust(width - 1))
        elif now - self.last >= self.every_s:
            self.last = now
            sys.stdout.write(text + "\n")
        sys.stdout.flush()

    def end(self):
        if self.terminal:
            sys.stdout.write("\n")
            sys.stdout.flush()


def progress_of(log_path):
    """(done, total) seconds of slam-sim's progress, None before its first line."""
    try:
        with open(log_path, "rb") as file:
            file.seek(max(0, os.path.getsize(log_path) - 2000))
            found = re.findall(rb"([\d.]+)/([\d.]+) s", file.read())
    except OSError:
        return None
    return tuple(float(number) for number in found[-1]) if found else None
