"""A simulated drive with GPS through the real daemon: the map finds its place on the earth, and clients are told."""

import array
import math
import os
import socket
import time
import unittest

from harness import EndToEndTest, in_real_time
from rigid import Truth, errors, multiply, rotate

ORIGIN = (48.2653, 11.6714)  # of the simulated world: degrees
RECEIVER_ERROR_M = 4.0       # 0.9 m an axis that last for a minute, four sigma
METRES_A_DEGREE = 111_200.0  # of latitude there, to a third of a per mille


def transform(pose):
    return tuple(pose["translation_m"]), tuple(pose["rotation_quat_xyzw"])


def compose(a, b):
    return tuple(x + y for x, y in zip(a[0], rotate(a[1], b[0]))), multiply(a[1], b[1])


def origin_in_world(enu):
    """East and north of the origin that the daemon chose, in the simulated world."""
    east = (enu["origin_lon_deg"] - ORIGIN[1]) * METRES_A_DEGREE * math.cos(math.radians(ORIGIN[0]))
    return east, (enu["origin_lat_deg"] - ORIGIN[0]) * METRES_A_DEGREE


class GeoReference(EndToEndTest):
    def back_end(self):
        return self.client.status()["health"]["back_end"]

    def await_aligned(self):
        """The state of the back end once the map has its place on the earth."""
        def aligned():
            state = self.back_end()
            return state if state["enu"] and state["changes"] >= 1 else None

        return self.await_value("the place of the map on the earth", aligned, 90.0)

    def map_header(self):
        """The first bytes of the file that get_map hands over."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as client:
            client.settimeout(30.0)
            client.connect(self.path("slamd.sock"))
            client.sendall(b'{"jsonrpc":"2.0","id":1,"method":"get_map"}\n')
            _, ancillary, _, _ = client.recvmsg(65536, socket.CMSG_SPACE(4))
        fds = array.array("i")
        for _, _, content in ancillary:
            fds.frombytes(content)
        self.assertEqual(len(fds), 1)
        with os.fdopen(fds[0], "rb") as file:
            file.seek(0)
            return file.read(1000).decode("ascii", errors="replace")

    @in_real_time
    def test_the_map_finds_its_place_on_the_earth_and_clients_are_told(self):
        daemon = self.start_daemon()
        self.start_simulator("--rest", "2", "--duration", "60", "--gps-rate", "5")
        self.await_pose("tracking", lambda pose: pose["status"] == "TRACKING")
        self.assertIsNone(self.back_end()["enu"])
        state = self.await_aligned()
        pose = self.await_pose("a correction", lambda pose: pose["map_corrections"] >= 1)
        time.sleep(0.2)  # a stamp that the truth has
        self.check_pose(pose)
        self.check_place(pose, state["enu"])
        self.check_gnss(state["gnss"])
        self.check_files(state["enu"])
        self.assert_stops_cleanly(daemon)

    def check_pose(self, pose):
        """map is corrected, odom is not: the two poses differ by T_map_odom, which is small on so short a drive."""
        composed = compose(transform(self.back_end()["T_map_odom"]), transform(pose["T_odom_base"]))
        distance_m, angle_rad = errors(composed, transform(pose["T_map_base"]))
        self.assertLess(distance_m, 0.2)  # another solve may lie in between
        self.assertLess(angle_rad, 0.01)
        self.assertNotEqual(pose["T_map_base"], pose["T_odom_base"])

    def check_place(self, pose, enu):
        truth = Truth(self.path("truth.tum")).at(pose["time_ns"] * 1e-9)
        T_enu_base = compose(transform(enu["T_enu_map"]), transform(pose["T_map_base"]))
        origin = origin_in_world(enu)
        distance_m = math.hypot(T_enu_base[0][0] + origin[0] - truth[0][0], T_enu_base[0][1] + origin[1] - truth[0][1])
        self.assertLess(distance_m, RECEIVER_ERROR_M)
        self.assertLess(errors(((0, 0, 0), T_enu_base[1]), ((0, 0, 0), truth[1]))[1], 4.0 * enu["yaw_sigma_rad"] + 0.02)

    def check_gnss(self, gnss):
        self.assertEqual(gnss["trust"], "trusted")
        self.assertLess(abs(gnss["latency_correction_s"]), 4.0 * gnss["latency_sigma_s"] + 0.01)

    def check_files(self, enu):
        header = self.map_header()
        self.assertIn("binary_compressed", header)
        saved = self.client.call("save_map", name="place.pcd")["result"]
        self.assertGreater(saved["points"], 10_000)
        with open(saved["reference_path"], encoding="ascii") as file:
            side = dict(line.strip().split(": ", 1) for line in file if ": " in line)
        self.assertAlmostEqual(float(side["origin_lat_deg"]), enu["origin_lat_deg"], places=8)
        self.assertAlmostEqual(float(side["origin_lon_deg"]), enu["origin_lon_deg"], places=8)
        self.assertIn(side["origin_lat_deg"][:9], header)
        self.assertGreater(self.client.status()["map"]["moved_keyframes"], 0)


if __name__ == "__main__":
    unittest.main()
