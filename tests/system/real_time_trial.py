"""Run inside the virtual machine: slamd as a service with a real-time kernel and the IMU board as a USB gadget that is plugged in and
out. Judges nothing: writes what it saw as JSON to the file that it is given."""

import contextlib
import glob
import json
import os
import subprocess
import sys
import termios
import threading
import time
import tty

from imu_frames import frame

GADGET = "/sys/kernel/config/usb_gadget/imu"
SERIAL = "E6617C93E3428A2F"
FRAME_S, BATCH = 0.005, 10
PATIENCE_S = 240.0  # a second of a processor may take this machine twenty
SOME_FRAMES = 1000   # whether they come punctually says nothing here: the board's thread has to share this machine
SETTLED_S = 5.0      # after it nothing starts any more
DROP_IN = "[Service]\nTimeoutStartSec=300s\nWatchdogSec=0\n"
NOT_TRACKING = 4     # slamctl's exit code: no LiDAR is here
CONFIG = 'imu:\n  device: /dev/slamd-imu\ngnss:\n  device: ""\n'


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def raw_without_waiting(path, flags):
    """A gadget's port is a terminal like any other: it would send CR LF where a frame has a byte of the value of LF."""
    port = os.open(path, flags | os.O_NOCTTY | os.O_NONBLOCK)
    tty.setraw(port)
    return port


def await_value(attempt, timeout_s=PATIENCE_S):
    """The last one that came, also when it is none."""
    end = time.monotonic() + timeout_s
    while not (value := attempt()) and time.monotonic() < end:
        time.sleep(0.2)
    return value


class Board:
    """Our IMU board, as far as USB and udev see it; its bytes come from a thread, whether somebody reads them or not."""

    def __init__(self):
        for module in ("dummy_hcd", "libcomposite"):
            run("modprobe", module)
        if not os.path.ismount("/sys/kernel/config"):
            run("mount", "-t", "configfs", "none", "/sys/kernel/config")
        for folder in ("strings/0x409", "configs/c.1/strings/0x409", "functions/acm.usb0"):
            os.makedirs(f"{GADGET}/{folder}")
        for name, text in (("idVendor", "0x1209"), ("idProduct", "0x0001"), ("strings/0x409/product", "slamd IMU"),
                           ("strings/0x409/manufacturer", "slamd"), ("strings/0x409/serialnumber", SERIAL)):
            write(f"{GADGET}/{name}", text)
        os.symlink(f"{GADGET}/functions/acm.usb0", f"{GADGET}/configs/c.1/acm.usb0")
        self.controller = os.listdir("/sys/class/udc")[0]
        threading.Thread(target=self.send, daemon=True).start()

    def plug_in(self):
        write(f"{GADGET}/UDC", self.controller)

    def pull_out(self):
        write(f"{GADGET}/UDC", "\n")

    def send(self):
        """Frames at rest, stamped by a clock of the board's own; none is kept for later while the board is out."""
        begin, sequence = time.monotonic(), 0
        while True:
            sequence += BATCH
            time.sleep(max(0.0, begin + sequence * FRAME_S - time.monotonic()))
            frames = b"".join(frame(n, round(1e6 * n * FRAME_S)) for n in range(sequence - BATCH, sequence))
            with contextlib.suppress(OSError, termios.error), open("/dev/ttyGS0", "wb", buffering=0, opener=raw_without_waiting) as port:
                port.write(frames)


def imu():
    """What the daemon says of the board; nothing as long as it says nothing."""
    answer = run("slamctl", "status", "--json")
    answered = answer.returncode in (0, NOT_TRACKING)
    return json.loads(answer.stdout)["health"]["sources"]["imu"] if answered else {"state": "unknown", "received": 0}


def has_read(frames):
    return await_value(lambda: imu()["received"] >= frames)


def kernel():
    mounts = [line.split() for line in read("/proc/mounts").splitlines()]
    return {"version": os.uname().version, "is_real_time": read("/sys/kernel/realtime").strip() == "1",
            "cgroups": sorted({kind for _, _, kind, *_ in mounts if kind.startswith("cgroup")})}


def port():
    status = os.stat("/dev/slamd-imu")
    return {"names": sorted(glob.glob("/dev/slamd-imu*")), "target": os.path.realpath("/dev/slamd-imu"),
            "mode": oct(status.st_mode & 0o777), "udev": run("udevadm", "info", "-q", "property", "/dev/slamd-imu").stdout.split("\n")}


def show(name):
    return run("systemctl", "show", "--value", "-p", name, "slamd").stdout.strip()


def process():
    pid = int(show("MainPID"))
    threads = {}
    for path in glob.glob(f"/proc/{pid}/task/*"):
        number = int(os.path.basename(path))
        threads[read(f"{path}/comm").strip()] = [os.sched_getscheduler(number), os.sched_getparam(number).sched_priority]
    status = dict(line.split(":\t", 1) for line in read(f"/proc/{pid}/status").splitlines() if ":\t" in line)
    limits = {line[:26].strip(): line[26:].split()[:2] for line in read(f"/proc/{pid}/limits").splitlines()}
    devices = sorted(os.readlink(path) for path in glob.glob(f"/proc/{pid}/fd/*") if os.path.exists(path))
    group = read(f"/proc/{pid}/cgroup").strip().split("::")[1]
    return {"threads": threads, "status": {name: status[name].strip() for name in ("CapEff", "Uid", "VmLck", "Seccomp")},
            "limits": {name: limits[name] for name in ("Max realtime priority", "Max locked memory")}, "devices": devices,
            "memory_max": read(f"/sys/fs/cgroup{group}/memory.max").strip()}


def started_by_plugging_in(board):
    """Of a service that is enabled, and stopped: before, with the board out, and with it in again."""
    run("systemctl", "stop", "slamd")
    states = []
    for enabled in ("disable", "enable"):
        run("systemctl", enabled, "slamd")
        board.pull_out()
        await_value(lambda: not os.path.exists("/dev/slamd-imu"))
        board.plug_in()
        await_value(lambda: os.path.exists("/dev/slamd-imu"))
        states.append(await_value(lambda: show("ActiveState") == "active", PATIENCE_S if enabled == "enable" else SETTLED_S))
    return states


def main():
    report = {"kernel": kernel()}
    board = Board()
    board.plug_in()
    await_value(lambda: os.path.exists("/dev/slamd-imu"))
    report["port"] = port()
    write("/etc/slamd/slamd.yaml", CONFIG)
    os.makedirs("/etc/systemd/system/slamd.service.d")
    write("/etc/systemd/system/slamd.service.d/slow.conf", DROP_IN)
    run("systemctl", "daemon-reload")
    report["start"] = run("systemctl", "start", "slamd").returncode
    run("systemctl", "set-property", "--runtime", "slamd.service", "MemoryMax=768M")
    report["reads"] = has_read(SOME_FRAMES)
    report["process"] = process()
    board.pull_out()
    report["absent"] = await_value(lambda: imu()["state"] == "absent")
    report["name_gone"] = await_value(lambda: not os.path.exists("/dev/slamd-imu"))
    before = imu()["received"]
    board.plug_in()
    report["reads_again"] = has_read(before + SOME_FRAMES)
    report["restarts"] = show("NRestarts")
    report["pulled_in"] = started_by_plugging_in(board)
    report["rt_check"] = run("slamd", "--config", "/etc/slamd/slamd.yaml", "--rt-check").stdout
    report["stop"] = [run("systemctl", "stop", "slamd").returncode, show("Result")]
    report["log"] = run("journalctl", "-u", "slamd", "--no-pager", "-n", "60").stdout
    write(sys.argv[1], json.dumps(report))


if __name__ == "__main__":
    main()
