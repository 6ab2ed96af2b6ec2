"""slam-sim as a program: a folder and a live run give the same bytes; bad command lines say what is wrong."""

import os
import select
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ["SLAM_SIM"]
DRIVE = ["--scenario", "parking", "--duration", "2", "--seed", "5", "--quiet"]


def pcap_payloads(path):
    with open(path, "rb") as file:
        data = file.read()
    assert struct.unpack("<I", data[:4])[0] == 0xA1B23C4D  # nanoseconds
    at, out = 24, {2368: [], 8308: []}
    while at < len(data):
        length = struct.unpack("<I", data[at + 8:at + 12])[0]
        frame = data[at + 16:at + 16 + length]
        out[struct.unpack(">H", frame[36:38])[0]].append(frame[42:])
        at += 16 + length
    return out


def listener():
    port = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 23)
    port.bind(("127.0.0.1", 0))
    return port


class Live:
    """A running slam-sim --live and everything it has sent."""

    def __init__(self, folder, extra):
        self.lidar, self.position = listener(), listener()
        self.imu_path, self.gps_path = os.path.join(folder, "imu"), os.path.join(folder, "gps")
        self.truth = os.path.join(folder, "truth.tum")
        self.process = subprocess.Popen(
            [PROGRAM, "--live", "--lidar-port", str(self.lidar.getsockname()[1]), "--position-port",
             str(self.position.getsockname()[1]), "--imu-pty", self.imu_path, "--gps-pty", self.gps_path,
             "--truth", self.truth] + extra)
        self.received = {}

    def open_tty(self, path):
        while not os.path.exists(path):
            assert self.process.poll() is None
            time.sleep(0.01)
        return os.open(path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)

    def listen(self, stop):
        """Collects until the program has ended, or stop(self) is true. Closes what it listened to."""
        open_sources = [self.lidar, self.position, self.open_tty(self.imu_path), self.open_tty(self.gps_path)]
        self.received = {source: [] for source in open_sources}
        while not stop(self):
            ready = select.select(open_sources, [], [], 0.2)[0]
            if not ready and self.process.poll() is not None:
                break
            for source in ready:
                try:
                    bytes_ = source.recv(2000) if isinstance(source, socket.socket) else os.read(source, 4096)
                except OSError:
                    bytes_ = b""
                if not bytes_:  # the pty is gone: the program has ended
                    open_sources.remove(source)
                self.received[source].append(bytes_)
        for source in self.received:
            source.close() if isinstance(source, socket.socket) else os.close(source)


class SlamSim(unittest.TestCase):
    def test_live_bytes_are_those_of_the_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "--out", folder + "/drive"] + DRIVE, check=True)
            live = Live(folder, DRIVE + ["--start-delay", "1.5"])
            live.listen(lambda _: False)
            self.assertEqual(live.process.wait(60.0), 0)
            recorded = pcap_payloads(folder + "/drive/lidar.pcap")
            self.assertEqual(live.received[live.lidar], recorded[2368])
            self.assertEqual(live.received[live.position], recorded[8308])
            with open(live.truth, encoding="ascii") as truth:
                stamps = [float(line.split()[0]) for line in truth]
            self.assertEqual(len(stamps), 201)
            self.assertLess(abs(stamps[-1] - time.clock_gettime(time.CLOCK_MONOTONIC)), 60)
            self.assertFalse(os.path.islink(live.imu_path))

    def test_an_interrupt_ends_it_cleanly(self):
        with tempfile.TemporaryDirectory() as folder:
            live = Live(folder, ["--scenario", "corridor", "--quiet", "--start-delay", "0"])
            live.listen(lambda run: len(run.received[run.lidar]) > 100)
            live.process.send_signal(signal.SIGINT)
            self.assertEqual(live.process.wait(60.0), 130)
            self.assertFalse(os.path.islink(live.imu_path))

    def test_bad_command_lines_name_what_is_bad(self):
        for arguments, token in ((["--out", "x", "--fault", "lidar:melt"], "melt"), (["--out", "x", "--world", "moon"], "moon"),
                                 (["--out", "x", "--rpm", "100"], "100"), ([], "--out"), (["--live", "--out", "x"], "--out"),
                                 (["--out", "/proc/none/x"], "/proc/none/x"), (["--out", "x", "--gps-sentences", "GGA,XYZ"], "XYZ"),
                                 (["--live", "--scenario", "house"], "no wire that slamd reads")):
            done = subprocess.run([PROGRAM] + arguments, capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 0, arguments)
            self.assertIn(token, done.stderr, arguments)

    def test_the_vehicle_is_told_where_the_sensors_are_and_not_how_they_are_tilted(self):
        with tempfile.TemporaryDirectory() as folder:
            mount = ["--lidar-mount", "1", "2", "3", "0", "0", "90", "--imu-tilt", "1", "0", "0", "--antenna", "0", "0", "2"]
            vehicles = []
            for arguments in (mount, mount + ["--lidar-tilt", "0", "2", "0"]):
                subprocess.run([PROGRAM, "--out", folder, "--no-gps"] + DRIVE + arguments, check=True)
                with open(folder + "/vehicle.yaml", encoding="ascii") as vehicle:
                    vehicles.append(vehicle.read())
            self.assertIn("[1.000000, 2.000000, 3.000000]", vehicles[0])
            self.assertIn("[0.000000000000, 0.000000000000, 0.707106781187, 0.707106781187]", vehicles[0])
            self.assertEqual(vehicles[0], vehicles[1])

    def test_the_house_is_a_folder_of_scans_and_wheels(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "--out", folder, "--scenario", "house", "--duration", "3", "--quiet"], check=True)
            self.assertEqual(sorted(os.listdir(folder)), ["imu.csv", "scan.csv", "truth.tum", "vehicle.yaml", "wheel.csv"])
            with open(folder + "/scan.csv", encoding="ascii") as scans:
                lines = scans.read().splitlines()
            self.assertEqual(lines[0], "t_ns,angle_begin_rad,angle_step_rad,beam_s,range_max_m,ranges_m")
            self.assertEqual([len(line.split(";")) for line in lines[1:]], [360] * 15)
            with open(folder + "/vehicle.yaml", encoding="ascii") as vehicle:
                self.assertIn("lidar_model: laser_scan", vehicle.read())
            subprocess.run([PROGRAM, "--out", folder, "--duration", "1", "--wheel", "--no-imu", "--no-gps", "--quiet"], check=True)
            self.assertEqual(sorted(os.listdir(folder)), ["lidar.pcap", "truth.tum", "vehicle.yaml", "wheel.csv"])

    def test_help_explains_scenarios_and_faults(self):
        text = subprocess.run([PROGRAM, "--help"], capture_output=True, text=True, check=True).stdout
        for word in ("two-laps", "moving-start", "clock-skew", "--imu-pty", "lidar:loss=0.02"):
            self.assertIn(word, text)


if __name__ == "__main__":
    unittest.main()
