"""The package installed on a booted machine, its service under a real systemd, fed by slam-sim over a wire and two ports."""

import contextlib
import glob
import grp
import json
import mmap
import os
import socket
import struct
import subprocess
import time
import unittest

from frozen_thread import FrozenThread
from machine import ADDRESS, Machine, await_value
from overlay_root import run

PACKAGES = os.environ["SLAMD_PACKAGES"]
SLAM_SIM = os.environ["SLAM_SIM"]
CAP_SYS_NICE, CAP_SYS_RESOURCE = 23, 24
SOCKET = "/run/slamd/slamd.sock"
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "sandbox_probe.py"), encoding="ascii") as probe_file:
    PROBE = probe_file.read()
RPC = '{"jsonrpc":"2.0","id":1,"method":"get_pose_page"}\n'

# What a test bench needs beyond a vehicle: ptys as serial ports.
DROP_IN = "[Service]\nDeviceAllow=char-pts rw\n"
# Where even root may not raise limits, LimitRTPRIO cannot be in force; real-time scheduling then comes from the capability.
NICE_DROP_IN = "CapabilityBoundingSet=CAP_SYS_NICE\nAmbientCapabilities=CAP_SYS_NICE\n"

OPEN_AGAIN_FOR_WRITING = f"""
import os, socket
link = socket.socket(socket.AF_UNIX); link.connect("{SOCKET}"); link.sendall(b'{RPC.strip()}\\n')
page = socket.recv_fds(link, 65536, 1)[1][0]
for way in (os.O_RDWR, os.O_WRONLY):
    try:
        os.open(f"/proc/self/fd/{{page}}", way)
        print("opened")
    except PermissionError:
        print("refused")
"""


def may(capability):
    with open("/proc/self/status", encoding="ascii") as status:
        effective = next(line for line in status if line.startswith("CapEff"))
    return bool(int(effective.split()[1], 16) >> capability & 1)


class Simulator:
    """slam-sim at rest, on the sensors' end of the cable; its ports as a vehicle has them."""

    def __init__(self, machine):
        links = [os.path.join(machine.folder, name) for name in ("imu", "gps")]
        command = ["ip", "netns", "exec", machine.cable.sensors, SLAM_SIM, "--live", "--quiet", "--udp-host", ADDRESS,
                   "--imu-pty", links[0], "--gps-pty", links[1], "--rest", "1200", "--duration", "1200"]
        with open(os.path.join(machine.folder, "slam-sim.log"), "wb") as log:
            self.child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        await_value("the ports", lambda: all(os.path.exists(link) for link in links), 60.0)
        ports = [os.path.realpath(link) for link in links]
        for port in ports:
            os.chown(port, -1, grp.getgrnam("dialout").gr_gid)
            os.chmod(port, 0o660)
        self.devices = list(zip(ports, ("/dev/ttyACM0", "/dev/ttyACM1")))

    def close(self):
        self.child.terminate()
        self.child.wait(30.0)


class ServiceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.machine = Machine()
        cls.addClassCleanup(cls.machine.close)
        cls.machine.prepare()
        simulator = Simulator(cls.machine)
        cls.addClassCleanup(simulator.close)
        cls.machine.boot(simulator.devices)
        cls.machine.install(PACKAGES, "slamd", "python3-slamd", "libslamd0", "slamd-dev")
        cls.fresh = [cls.machine.call("systemctl", question, "slamd.service", "slamd.socket", check=False).stdout.split()
                     for question in ("is-enabled", "is-active")]
        cls.machine.write("/etc/systemd/system/slamd.service.d/bench.conf",
                          DROP_IN + ("" if may(CAP_SYS_RESOURCE) else NICE_DROP_IN))
        for user, group in (("driver", "slamd"), ("stranger", "nogroup")):
            cls.machine.call("useradd", "--groups", group, user)
        cls.machine.call("systemctl", "daemon-reload")
        cls.machine.call("systemctl", "enable", "--now", "slamd")
        cls.await_tracking()

    def setUp(self):
        if self.machine.show("slamd", "ActiveState") != "active":
            self.machine.call("systemctl", "start", "slamd")
        self.await_tracking()

    @classmethod
    def await_tracking(cls):
        try:
            return await_value("TRACKING", lambda: cls.status().startswith("TRACKING"), 60.0)
        except AssertionError as failure:
            raise AssertionError(f"{failure}, {cls.status()}\n{cls.log()}") from failure

    @classmethod
    def status(cls):
        return cls.machine.show("slamd", "StatusText")

    @classmethod
    def log(cls):
        return cls.machine.call("journalctl", "-u", "slamd", "-n", "40", "--no-pager").stdout

    def restarts(self):
        return int(self.machine.show("slamd", "NRestarts"))

    def pid(self):
        """Of the daemon, as this side counts."""
        namespace = os.readlink(f"/proc/{self.machine.leader}/ns/pid")
        for path in glob.glob("/proc/[0-9]*"):
            with contextlib.suppress(OSError), open(f"{path}/comm", encoding="ascii") as name:
                if name.read().strip() == "slamd" and os.readlink(f"{path}/ns/pid") == namespace:
                    return int(os.path.basename(path))
        return self.fail("no slamd in the machine")

    def thread(self, name):
        for path in glob.glob(f"/proc/{self.pid()}/task/*/comm"):
            with open(path, encoding="ascii") as comm:
                if comm.read().strip() == name:
                    return int(path.split("/")[-2])
        return self.fail(f"no thread {name}")

    def connect(self):
        link = socket.socket(socket.AF_UNIX)
        self.addCleanup(link.close)
        link.settimeout(30.0)
        link.connect(f"/proc/{self.machine.leader}/root{SOCKET}")
        return link

    def as_user(self, user, *command):
        return self.machine.call("runuser", "-u", user, "--", *command, check=False)

    def test_an_installation_enables_and_starts_nothing(self):
        self.assertEqual(self.fresh, [["disabled", "disabled"], ["inactive", "inactive"]])

    def test_it_is_ready_and_its_status_line_says_how_all_stands(self):
        self.assertEqual(self.machine.show("slamd", "Type"), "notify")
        await_value("every sensor", lambda: self.status() == "TRACKING; lidar healthy, imu healthy, gnss healthy, checkpoint healthy", 30.0)

    def test_members_of_the_group_get_the_pose_and_others_are_refused(self):
        answer = self.as_user("driver", "slamctl", "pose", "--json")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        pose = json.loads(answer.stdout)
        self.assertEqual(pose["status"], "TRACKING")
        self.assertLess(max(map(abs, pose["T_odom_base"]["translation_m"])), 0.2, "it stands where it started")
        refused = self.as_user("stranger", "slamctl", "pose", "--json")
        self.assertEqual((refused.returncode, refused.stdout), (3, ""))

    def test_programs_made_with_the_installed_client_library_ask_the_service(self):
        self.machine.call("cp", "-r", "/usr/share/doc/slamd-dev/examples", "/tmp/examples")
        self.machine.call("cmake", "-S", "/tmp/examples", "-B", "/tmp/examples/build")
        self.machine.call("cmake", "--build", "/tmp/examples/build")
        told = self.as_user("driver", "/tmp/examples/build/follow").stdout.splitlines()
        self.assertEqual([line.split()[1] for line in told], ["TRACKING"] * 11, told)
        told = self.as_user("driver", "/tmp/examples/build/save_map", "/tmp/driver.ply")
        self.assertRegex(told.stdout, r'^"TRACKING"\nx -?[0-9.e-]+ m\n[1-9][0-9]* points\n$')

    def test_a_client_that_has_the_pose_page_cannot_open_it_for_writing(self):
        answer = self.as_user("driver", "python3", "-c", OPEN_AGAIN_FOR_WRITING)
        self.assertEqual(answer.stdout.split(), ["refused", "refused"], answer.stderr)

    def test_a_hanging_estimator_is_named_killed_and_started_again(self):
        before = self.restarts()
        with FrozenThread(self.thread("slamd-estimator")) as frozen:
            await_value("the watchdog", lambda: frozen.look() and self.restarts() > before, 30.0)
        self.await_tracking()
        self.assertIn("watchdog state=starving part=estimator", self.log())
        self.assertIn("Watchdog timeout", self.log())

    def test_killed_it_comes_back_and_mappings_of_the_pose_page_stay_good(self):
        link = self.connect()
        link.sendall(RPC.encode())
        page = mmap.mmap(socket.recv_fds(link, 65536, 1)[1][0], 4096, mmap.MAP_SHARED, mmap.PROT_READ)
        self.addCleanup(page.close)
        starts = struct.unpack_from("<I", page, 16)[0]
        begin = time.monotonic()
        self.machine.call("systemctl", "kill", "--signal=KILL", "slamd")
        await_value("a pose on the same page",
                    lambda: struct.unpack_from("<I", page, 16)[0] == starts + 1 and self.page_status(page) == 1, 60.0)
        print(f"kill -9 to TRACKING on the page: {time.monotonic() - begin:.2f} s", flush=True)

    @staticmethod
    def page_status(page):
        """0 INITIALISING, 1 TRACKING, ...; None as long as there is no pose."""
        if struct.unpack_from("<Q", page, 64)[0] == 0:
            return None
        return struct.unpack_from("<I", page, 72 + 62 * 8)[0]

    def test_a_client_of_a_stopped_service_starts_it(self):
        self.machine.call("systemctl", "stop", "slamd.service")
        self.assertEqual(self.machine.show("slamd", "ExecMainStatus"), "0")
        self.assertEqual(self.machine.show("slamd.socket", "ActiveState"), "active")
        link = self.connect()
        link.sendall(b'{"jsonrpc":"2.0","id":1,"method":"version"}\n')
        self.assertEqual(json.loads(link.makefile().readline())["result"]["daemon"], "slamd")
        self.assertEqual(self.machine.show("slamd", "ActiveState"), "active")

    def test_a_reload_takes_over_a_good_file_and_says_no_to_a_bad_one(self):
        pid = self.pid()
        self.machine.write("/etc/slamd/slamd.yaml", "log:\n  repeat_period_s: 3\n")
        self.machine.call("systemctl", "reload", "slamd")
        await_value("the news", lambda: "config state=reloaded" in self.log(), 10.0)
        self.machine.write("/etc/slamd/slamd.yaml", "log:\n  repeat_period: 3\n")
        self.assertNotEqual(self.machine.call("systemctl", "reload", "slamd", check=False).returncode, 0)
        self.assertIn("slamd.yaml:2: log.repeat_period: unknown key", self.log())
        self.machine.write("/etc/slamd/slamd.yaml", "log:\n  repeat_period_s: 3\n")
        self.assertEqual((self.pid(), self.machine.show("slamd", "ActiveState")), (pid, "active"))

    def test_the_journal_has_fields(self):
        lines = self.machine.call("journalctl", "-o", "json", "SLAMD_SUBJECT=imu", "SLAMD_STATE=healthy").stdout.splitlines()
        entry = json.loads(lines[-1])
        self.assertEqual((entry["SLAMD_DEVICE"], entry["PRIORITY"], entry["_SYSTEMD_UNIT"]),
                         ("/dev/ttyACM0", "6", "slamd.service"))
        self.assertGreater(int(entry["SLAMD_RECEIVED"]), 0)

    def test_it_runs_as_its_user_with_real_time_threads_and_no_more_rights_than_it_needs(self):
        pid = self.pid()
        with open(f"/proc/{pid}/status", encoding="ascii") as file:
            status = dict(line.split(":\t", 1) for line in file.read().splitlines() if ":\t" in line)
        allowed = 0 if may(CAP_SYS_RESOURCE) else 1 << CAP_SYS_NICE
        self.assertEqual((int(status["CapEff"], 16), int(status["CapBnd"], 16)), (allowed, allowed))
        self.assertEqual((status["NoNewPrivs"], status["Seccomp"]), ("1", "2"))
        self.assertEqual(self.machine.call("stat", "-c", "%U", f"/proc/{status['NSpid'].split()[-1]}").stdout.strip(), "slamd")
        for name, priority in (("slamd-imu", 60), ("slamd-lidar", 50), ("slamd-estimator", 40)):
            thread = self.thread(name)
            self.assertEqual(os.sched_getscheduler(thread), os.SCHED_FIFO, name)
            self.assertEqual(os.sched_getparam(thread).sched_priority, priority, name)

    def test_the_rest_of_the_system_is_closed_to_it(self):
        """Seen from inside its mount namespace."""
        def inside(*command):
            return run("nsenter", "-t", str(self.pid()), "-m", "--", *command, check=False)
        self.assertNotEqual(inside("touch", "/etc/slamd/x", "/usr/x").returncode, 0)
        self.assertEqual(inside("touch", "/var/lib/slamd/maps/x").returncode, 0)
        self.assertEqual(inside("sh", "-c", "ls /home /root").stdout.split(), ["/home:", "/root:"])

    def test_what_the_unit_forbids_is_refused_and_nothing_else(self):
        """Tried by a program of the service, and outside it: so it is the unit that refuses."""
        self.machine.write("/probe.py", PROBE)
        self.machine.write("/etc/systemd/system/slamd.service.d/probe.conf",
                           "[Service]\nExecStartPre=/usr/bin/python3 -B /probe.py /var/lib/slamd/probe.json\n")
        self.addCleanup(self.machine.call, "systemctl", "daemon-reload")
        self.addCleanup(self.machine.call, "rm", "/etc/systemd/system/slamd.service.d/probe.conf", "/var/lib/slamd/probe.json")
        self.machine.call("systemctl", "daemon-reload")
        self.machine.call("systemctl", "restart", "slamd")
        self.machine.call("install", "-d", "-o", "slamd", "/tmp/outside")
        self.machine.call("runuser", "-u", "slamd", "--", "python3", "-B", "/probe.py", "/tmp/outside/probe.json")
        inside, outside = (json.loads(self.machine.call("cat", f"{folder}/probe.json").stdout)
                           for folder in ("/var/lib/slamd", "/tmp/outside"))
        self.assertEqual([name for name, possible in outside.items() if not possible], [])
        self.assertEqual([name for name, possible in inside.items() if possible],
                         ["UDP", "a local socket", "a file of its state", "a temporary file"])

    def test_packets_from_outside_the_private_networks_do_not_reach_it(self):
        cable = self.machine.cable
        cable.address(cable.machine, "lidar0", "203.0.113.8")
        cable.address(cable.sensors, "vlp16", "203.0.113.9")
        self.send("203.0.113.8", 5)
        self.assertEqual(self.rejected(), 0)
        self.send(ADDRESS, 5)
        await_value("those from the LiDAR's network", lambda: self.rejected() == 5, 10.0)

    def send(self, address, count):
        """Datagrams of a byte, which no LiDAR sends."""
        script = f"exec 3>/dev/udp/{address}/2368; for i in $(seq {count}); do printf x >&3; done"
        run("ip", "netns", "exec", self.machine.cable.sensors, "bash", "-c", script)
        time.sleep(0.5)  # an answer of get_status may be 0.1 s old

    def rejected(self):
        status = json.loads(self.as_user("driver", "slamctl", "status", "--json").stdout)
        return sum(status["health"]["sources"]["lidar"]["rejected"].values())

    def test_a_second_sensor_set_runs_beside_the_first(self):
        self.machine.write("/etc/slamd/rear.yaml",
                           "lidar:\n  port: 2369\n  position_port: 8309\nimu:\n  device: \"\"\ngnss:\n  device: \"\"\n")
        self.machine.call("systemctl", "start", "slamd@rear")
        answer = self.as_user("driver", "slamctl", "--socket", "/run/slamd/rear.sock", "status", "--json")
        self.assertEqual(json.loads(answer.stdout)["pose"]["status"], "INITIALISING")
        self.machine.call("systemctl", "stop", "slamd@rear.socket", "slamd@rear.service")


if __name__ == "__main__":
    unittest.main()
