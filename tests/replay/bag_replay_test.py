"""slam-replay on bags that are made of a recorded drive: ROS 1 and ROS 2 give the path that the drive folder gives, without an IMU and broken off
too. SLAM_REPLAY and SLAMD_SHARED_DATA come from ctest."""
import json
import math
import os
import sqlite3
import struct
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DRIVE = os.path.join(os.environ["SLAMD_SHARED_DATA"], "drive_sample")
LENGTH_S = 12.0
UTC_NS = 1_000_000_000_000  # stamps of the bags are so much later than the drive's
PACKETS_A_SCAN = 76


class Ros1:
    """Packed, little-endian."""

    def __init__(self):
        self.bytes = bytearray()

    def put(self, form, *numbers):
        for letter, number in zip(form if len(form) == len(numbers) else form * len(numbers), numbers):
            self.align(struct.calcsize(letter))
            self.bytes += struct.pack("<" + letter, number)
        return self

    def align(self, size):
        pass

    def text(self, text):
        self.put("I", len(text))
        self.bytes += text.encode()

    def time(self, t_ns):
        self.put("II", t_ns // 10**9, t_ns % 10**9)

    def header(self, t_ns):
        self.put("I", 0)
        self.time(t_ns)
        self.text("frame")


class Cdr(Ros1):
    """XCDR1, little-endian."""

    def __init__(self):
        super().__init__()
        self.bytes += b"\0\1\0\0"

    def align(self, size):
        self.bytes += bytes(-(len(self.bytes) - 4) % size)

    def text(self, text):
        self.put("I", len(text) + 1)
        self.bytes += text.encode() + b"\0"

    def header(self, t_ns):
        self.time(t_ns)
        self.text("frame")


def packets(path):
    """(arrival, payload) of the data packets of a pcap file with stamps in nanoseconds or microseconds."""
    with open(path, "rb") as file:
        magic = struct.unpack("<I", file.read(24)[:4])[0]
        unit = 1 if magic == 0xA1B23C4D else 1000
        while len(head := file.read(16)) == 16:
            seconds, fraction, size, _ = struct.unpack("<IIII", head)
            payload = file.read(size)[42:]
            if len(payload) == 1206:
                yield seconds * 10**9 + fraction * unit, payload


def rows(path):
    with open(path, encoding="ascii") as file:
        for line in file.read().splitlines()[1:]:
            yield line.split(",", 1)


def scan_message(form, scan):
    message = form()
    message.header(scan[-1][0] + UTC_NS)
    message.put("I", len(scan))
    for t_ns, payload in scan:
        message.time(t_ns + UTC_NS)
        message.bytes += payload
    return bytes(message.bytes)


def imu_message(form, t_ns, values):
    message = form()
    message.header(t_ns + UTC_NS)
    message.put("d", *[0.0] * 13, *values[:3], *[0.0] * 9, *values[3:6], *[0.0] * 9)
    return bytes(message.bytes)


def sentence_message(form, t_ns, sentence):
    message = form()
    message.header(t_ns + UTC_NS)
    message.text(sentence)
    return bytes(message.bytes)


def messages(form):
    """(time, topic, type, bytes) of the drive's begin, in order of time."""
    found = []
    scan = []
    begin_ns = None
    for t_ns, payload in packets(os.path.join(DRIVE, "lidar.pcap")):
        begin_ns = begin_ns or t_ns
        if t_ns - begin_ns > LENGTH_S * 1e9:
            break
        scan.append((t_ns, payload))
        if len(scan) == PACKETS_A_SCAN:
            found.append((t_ns, "/velodyne_packets", "velodyne_msgs/VelodyneScan", scan_message(form, scan)))
            scan = []
    for word, rest in rows(os.path.join(DRIVE, "imu.csv")):
        t_ns = int(word)
        if t_ns - begin_ns <= LENGTH_S * 1e9:
            values = [float(value) for value in rest.split(",")]
            found.append((t_ns, "/imu/data", "sensor_msgs/Imu", imu_message(form, t_ns, values)))
    for word, sentence in rows(os.path.join(DRIVE, "gps.csv")):
        t_ns = int(word)
        if t_ns - begin_ns <= LENGTH_S * 1e9:
            found.append((t_ns, "/nmea", "nmea_msgs/Sentence", sentence_message(form, t_ns, sentence)))
    return sorted(found)


def write_db3(path, found):
    with sqlite3.connect(path) as bag:
        bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)")
        bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        ids = {}
        for t_ns, topic, kind, content in found:
            if topic not in ids:
                ids[topic] = len(ids) + 1
                bag.execute("INSERT INTO topics VALUES(?,?,?,'cdr','')", (ids[topic], topic, kind.replace("/", "/msg/")))
            bag.execute("INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", (ids[topic], t_ns + UTC_NS, content))
    bag.close()


def record(fields, body):
    head = b"".join(struct.pack("<I", len(f)) + f for f in (name.encode() + b"=" + value for name, value in fields.items()))
    return struct.pack("<I", len(head)) + head + struct.pack("<I", len(body)) + body


def write_ros1(path, found):
    """Without an index, as a bag whose recorder was killed."""
    ids = {}
    with open(path, "wb") as bag:
        bag.write(b"#ROSBAG V2.0\n" + record({"op": b"\x03", "index_pos": bytes(8), "conn_count": bytes(4), "chunk_count": bytes(4)}, b" " * 4000))
        for begin in range(0, len(found), 200):
            chunk = b""
            for t_ns, topic, kind, content in found[begin:begin + 200]:
                if topic not in ids:
                    ids[topic] = struct.pack("<I", len(ids))
                    about = record({"topic": topic.encode(), "type": kind.encode()}, b"")
                    chunk += record({"op": b"\x07", "conn": ids[topic], "topic": topic.encode()}, about[4:-4])
                time = struct.pack("<II", (t_ns + UTC_NS) // 10**9, (t_ns + UTC_NS) % 10**9)
                chunk += record({"op": b"\x02", "conn": ids[topic], "time": time}, content)
            bag.write(record({"op": b"\x05", "compression": b"none", "size": struct.pack("<I", len(chunk))}, chunk))


@unittest.skipUnless(os.path.isdir(DRIVE), "shared data is absent: " + DRIVE)
class Bags(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temp = tempfile.TemporaryDirectory()
        cls.ros1, cls.ros2 = messages(Ros1), messages(Cdr)
        cls.folder_path = cls.places(cls.replay(DRIVE, "folder", "--no-gps")[0])

    @classmethod
    def tearDownClass(cls):
        cls.temp.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.temp.name, name)

    @classmethod
    def replay(cls, drive, name, *options):
        run = subprocess.run([os.environ["SLAM_REPLAY"], drive, "--out", cls.path(name), "--no-map",
                              "--set", "lidar.vertical_offsets=false", *options], capture_output=True, text=True, check=False, timeout=300)
        if run.returncode != 0:
            raise AssertionError(f"slam-replay ended with {run.returncode}: {run.stderr}")
        return cls.path(name), run.stderr

    @staticmethod
    def places(out):
        """Times and places of odom.tum."""
        with open(os.path.join(out, "odom.tum"), encoding="ascii") as file:
            found = [[float(word) for word in line.split()[:4]] for line in file]
        return [(row[0], row[1:4]) for row in found]

    def report(self, out):
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            return json.load(file)

    def assert_same_path(self, out, within_m):
        found = []
        for t, place in self.places(out):
            off_s, wanted = min((abs(t - UTC_NS * 1e-9 - at), wanted) for at, wanted in self.folder_path)
            if off_s < 0.02:
                found.append((place, wanted))
        self.assertGreater(len(found), 60)
        self.assertGreater(math.dist(found[0][1], found[-1][1]), 15.0, "it drove")
        worst = max(abs(math.dist(place, found[0][0]) - math.dist(wanted, found[0][1])) for place, wanted in found)
        self.assertLess(worst, within_m)

    def test_a_ros_2_bag_gives_the_path_of_its_drive(self):
        write_db3(self.path("drive.db3"), self.ros2)
        out, told = self.replay(self.path("drive.db3"), "ros2")
        self.assert_same_path(out, 0.3)
        self.assertGreater(self.report(out)["gps_fixes"], 8)
        self.assertNotIn("no IMU", told)

    def test_a_ros_1_bag_whose_recorder_was_killed_gives_the_path_of_its_drive(self):
        write_ros1(self.path("drive.bag"), self.ros1)
        with open(self.path("drive.bag"), "ab") as bag:
            bag.write(b"\x00\x01")  # and the begin of what it was writing
        out, told = self.replay(self.path("drive.bag"), "ros1")
        self.assert_same_path(out, 0.3)
        self.assertRegex(told, r"drive\.bag: byte \d+: a record breaks off")

    def test_without_an_imu_the_lidar_runs_alone_and_one_line_says_so(self):
        write_db3(self.path("lidar.db3"), [m for m in self.ros2 if m[1] == "/velodyne_packets"])
        out, told = self.replay(self.path("lidar.db3"), "lidar")
        self.assertGreater(self.report(out)["scans"], 60)
        self.assertIn("no IMU: the LiDAR alone; no GPS", told)

    def test_list_says_what_each_topic_is_taken_for(self):
        write_db3(self.path("list.db3"), self.ros2)
        run = subprocess.run([os.environ["SLAM_REPLAY"], "--list", self.path("list.db3")], capture_output=True, text=True, check=True)
        roles = {line.split()[3]: line.split()[0] for line in run.stdout.splitlines()[1:]}
        self.assertEqual(roles, {"/velodyne_packets": "lidar", "/imu/data": "imu", "/nmea": "gps"})


if __name__ == "__main__":
    unittest.main()
