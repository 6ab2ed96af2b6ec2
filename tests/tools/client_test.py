"""The Python client and slamctl against a real server over a made-up drive (tests/support/canned_server.cpp)."""

import asyncio
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zipfile

NUMPY_SCRIPT = """
import sys
import slamd
with slamd.Client(sys.argv[1]) as daemon:
    page = daemon.pose_page()
    view = page.view()
    first, sample = int(view["sequence"]), page.read()
    while int(view["sequence"]) == first: pass
    assert view["covariance"].shape == (6, 6) and view["covariance"][5, 5] == 0.01 == sample.covariance[35]
    assert view["map_position_m"][1:].tolist() == [2.0, 3.0] and view["map_corrections"] == sample.map_corrections
    assert not view.flags.writeable and not view.flags.owndata
    with daemon.map_view(voxel_size_m=0.5) as cloud:
        rows = cloud.rows()
        assert rows.shape == (len(cloud), 4) and not rows.flags.writeable and not rows.flags.owndata
        assert bytes(cloud.memory()) == rows.tobytes()
        assert sorted(set((rows[:, 0] % 1.0).tolist())) == [0.5], "points are 0.5 m off whole metres"
        del rows
    print(len(daemon.call("get_trajectory")["poses"]), "seen")
"""

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEBIAN_PYTHON = "/usr/bin/python3"
PYTHON_CLIENT = os.path.join(SOURCE, "tools", "client", "python")
sys.path.insert(0, PYTHON_CLIENT)

import slamd  # noqa: E402


def has_numpy(python):
    return shutil.which(python) is not None and subprocess.run([python, "-c", "import numpy"], capture_output=True).returncode == 0


class Types(unittest.TestCase):
    def test_the_type_hints_are_strict(self):
        if shutil.which("mypy") is None:
            self.skipTest("no mypy")
        done = subprocess.run(["mypy", "--strict", "--cache-dir", os.devnull, "slamd"], cwd=PYTHON_CLIENT, capture_output=True,
                              text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout)


class Wheel(unittest.TestCase):
    def test_it_is_made_without_a_download_and_holds_the_client(self):
        """By Debian's own pip; in a copy, since setuptools writes beside its sources."""
        probe = [DEBIAN_PYTHON, "-c", "import setuptools, pip, wheel"]
        if shutil.which(DEBIAN_PYTHON) is None or subprocess.run(probe, capture_output=True).returncode != 0:
            self.skipTest("no python3-pip, python3-setuptools, python3-wheel")
        folder = tempfile.mkdtemp(prefix="slamd_wheel_")
        self.addCleanup(shutil.rmtree, folder)
        source = shutil.copytree(PYTHON_CLIENT, os.path.join(folder, "source"))
        done = subprocess.run([DEBIAN_PYTHON, "-m", "pip", "wheel", "--no-index", "--no-deps", "--no-build-isolation",
                               "--wheel-dir", folder, source], capture_output=True, text=True, timeout=240)
        self.assertEqual(done.returncode, 0, done.stderr)
        wheel = os.path.join(folder, "slamd-0.1.0-py3-none-any.whl")
        with zipfile.ZipFile(wheel) as files:
            self.assertIn("slamd/py.typed", files.namelist())
        done = subprocess.run([sys.executable, "-c", "import slamd; print(slamd.__file__)"], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": wheel}, timeout=60)
        self.assertIn(wheel, done.stdout)


class WithServer(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="slamd_client_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.path = os.path.join(self.folder, "slamd.sock")
        self.server = subprocess.Popen([os.environ["CANNED_SERVER"], self.path, self.folder], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, text=True)
        self.addCleanup(self.stop)
        self.assertEqual(self.server.stdout.readline(), "ready\n")

    def stop(self):
        self.server.stdin.close()
        self.server.wait(60)
        self.server.stdout.close()

    def slamctl(self, *arguments, code=0):
        done = subprocess.run([os.environ["SLAMCTL"], *arguments], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "SLAMD_SOCKET": self.path})
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout


class BlockingClient(WithServer):
    def test_calls_give_results_and_errors_are_exceptions(self):
        with slamd.Client(self.path) as daemon:
            self.assertEqual(daemon.version["protocol"], 1)
            self.assertEqual(daemon.call("get_status")["map"]["keyframes"], 100)
            with self.assertRaises(slamd.RpcError) as caught:
                daemon.call("no_such_method")
            self.assertEqual(caught.exception.code, -32601)
            self.assertEqual(daemon.call("get_status")["version"], "0.0.1")

    def test_poses_come_in_order(self):
        with slamd.Client(self.path) as daemon:
            sequences = []
            for pose in daemon.poses(rate_hz=200):
                sequences.append(pose["sequence"])
                if len(sequences) == 20:
                    break
            self.assertEqual(sequences, sorted(set(sequences)))

    def test_the_map_comes_as_a_file(self):
        with slamd.Client(self.path) as daemon:
            result, pcd = daemon.map_bytes(voxel_size_m=0.5, box={"min_m": [0, 0, 0], "max_m": [9.9, 99, 9]})
            self.assertEqual(result["points"], 500)
            self.assertEqual(len(pcd), result["bytes"])
            self.assertTrue(pcd.startswith(b"# .PCD"))
            self.assertEqual(len(daemon.trajectory_tum().splitlines()), 100)

    def test_the_grid_comes_as_squares_and_a_change_is_told(self):
        with slamd.Client(self.path) as daemon:
            daemon.subscribe("grid", 4.0)
            topic, told = next(daemon.notifications())
            self.assertEqual((topic, told["width"], told["changes"]), ("grid", 3, 1))
            grid = daemon.grid()
        self.assertEqual((grid.width, grid.height, grid.resolution_m, grid.origin_m), (3, 2, 0.5, (-1.0, 2.0)))
        self.assertEqual([grid.at(-0.9, 2.1), grid.at(0.4, 2.9), grid.at(0.4, 2.1), grid.at(9.0, 2.1)], [100, -1, 0, -1])

    def test_the_pose_page_agrees_with_the_socket_and_outlives_the_connection(self):
        with slamd.Client(self.path) as daemon:
            page = daemon.pose_page()
            pose = daemon.call("get_pose")
        sample = page.read()
        while sample.sequence < pose["sequence"]:
            sample = page.read()
        self.assertEqual(page.starts(), 1)
        self.assertEqual(sample.status, "TRACKING")
        self.assertEqual(sample.map_position_m[1:], (2.0, 3.0))
        self.assertEqual(sample.map_rotation_xyzw, (0.0, 0.0, 0.0, 1.0))
        self.assertEqual([sample.covariance[i * 7] for i in range(6)], [0.01] * 6)
        self.assertEqual(list(sample.covariance), pose["covariance"])
        self.assertIsNone(sample.utc_offset_ns)
        self.assertLess(abs(time.monotonic_ns() - sample.time_ns), 60e9)

    def test_nobody_at_the_socket_and_a_daemon_that_leaves_are_clear_errors(self):
        with self.assertRaises(slamd.ConnectionLost):
            slamd.Client(os.path.join(self.folder, "none.sock"))
        with slamd.Client(self.path) as daemon:
            self.server.stdin.close()
            self.server.wait(60)
            with self.assertRaises(slamd.ConnectionLost):
                daemon.call("get_status")


    def test_page_and_map_are_seen_where_they_lie_without_numpy(self):
        with slamd.Client(self.path) as daemon:
            page = daemon.pose_page()
            memory = page.memory()
            before = page.lock()
            while page.lock() == before:
                pass
            self.assertTrue(memory.readonly)
            self.assertGreater(struct.unpack_from("<Q", memory, 16)[0], 1, "sequence")
            with daemon.map_view(voxel_size_m=0.5) as cloud:
                self.assertEqual((len(cloud), cloud.told["points"]), (5000, 5000))
                points = cloud.memory()
                self.assertTrue(points.readonly)
                self.assertEqual(struct.unpack_from("<f", points, 16 * 4999)[0] % 1.0, 0.5)
                points.release()

    def test_page_and_map_are_numpy_arrays_without_a_copy(self):
        python = next((python for python in (sys.executable, "/usr/bin/python3") if has_numpy(python)), None)
        if python is None:
            self.skipTest("no numpy (python3-numpy)")
        done = subprocess.run([python, "-c", NUMPY_SCRIPT, self.path], capture_output=True, text=True, timeout=120,
                              env={**os.environ, "PYTHONPATH": PYTHON_CLIENT})
        self.assertEqual((done.returncode, done.stdout), (0, "100 seen\n"), done.stderr)

    def test_descriptors_that_nobody_took_are_closed(self):
        with slamd.Client(self.path) as daemon:
            before = len(os.listdir("/proc/self/fd"))
            for _ in range(3):
                daemon.call("get_pose_page")
            self.assertEqual(len(os.listdir("/proc/self/fd")), before)


class AsynchronousClient(WithServer):
    def test_overlapping_calls_poses_and_map(self):
        async def use():
            daemon = await slamd.AsyncClient.connect(self.path)
            statuses = await asyncio.gather(*(daemon.call("get_status") for _ in range(10)))
            self.assertTrue(all(status["map"]["keyframes"] == 100 for status in statuses))
            count = 0
            async for pose in daemon.poses(rate_hz=200):
                self.assertEqual(pose["status"], "TRACKING")
                count += 1
                if count == 10:
                    break
            result, ply = await daemon.map_bytes(format="ply")
            self.assertEqual(len(ply), result["bytes"])
            self.assertGreater((await daemon.pose_page()).read().sequence, 0)
            self.assertEqual(len(await daemon.map_view(voxel_size_m=0.5)), 5000)
            self.assertEqual(daemon.version["protocol"], 1)
            self.assertEqual((await daemon.grid()).at(-0.9, 2.1), 100)
            with self.assertRaises(slamd.RpcError):
                await daemon.call("get_map", voxel_size_m=0)
            daemon.close()
            with self.assertRaises(slamd.ConnectionLost):
                await daemon.call("get_status")
        asyncio.run(use())


class Slamctl(WithServer):
    def test_status_and_pose_as_text_and_json(self):
        self.assertIn("TRACKING", self.slamctl("status"))
        self.assertEqual(json.loads(self.slamctl("status", "--json"))["pose"]["status"], "TRACKING")
        watched = self.slamctl("status", "--watch", "--interval", "0.2", "--count", "3", "--json").splitlines()
        self.assertEqual([json.loads(line)["pose"]["status"] for line in watched], ["TRACKING"] * 3)
        self.assertIn("y 2.000  z 3.000 m", self.slamctl("pose"))
        lines = self.slamctl("pose", "--follow", "--rate", "200", "--count", "5", "--json").splitlines()
        self.assertEqual(len({json.loads(line)["sequence"] for line in lines}), 5)

    def test_map_and_trajectory_become_files(self):
        for name, start in (("map.pcd", b"# .PCD"), ("map.ply", b"ply\n")):
            path = os.path.join(self.folder, name)
            told = json.loads(self.slamctl("map", "save", path, "--voxel", "0.5", "--json"))
            with open(path, "rb") as file:
                content = file.read()
            self.assertTrue(content.startswith(start))
            self.assertEqual(told["bytes"], len(content))
        self.assertIn("3 x 2 squares", self.slamctl("grid", "--out", os.path.join(self.folder, "house.pgm")))
        with open(os.path.join(self.folder, "house.pgm"), "rb") as file:
            self.assertEqual(file.read(), b"P5\n3 2\n255\n\xfe\xfe\xcd\x00\xfe\xfe")
        with open(os.path.join(self.folder, "house.yaml"), encoding="ascii") as file:
            self.assertIn("image: house.pgm\nmode: trinary\nresolution: 0.5\norigin: [-1, 2, 0]\n", file.read())
        path = os.path.join(self.folder, "drive.tum")
        self.assertIn("100 poses", self.slamctl("trajectory", "save", path))
        with open(path, encoding="ascii") as file:
            self.assertEqual(len(file.readlines()), 100)
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ["drive.tum", "house.pgm", "house.yaml", "map.pcd", "map.ply", "slamd.sock", "slamd.sock.lock"])

    def test_metrics_are_prometheus_text(self):
        told = self.slamctl("metrics").splitlines()
        self.assertIn('slamd_status{status="TRACKING"} 1', told)
        self.assertIn("slamd_map_keyframes 100", told)

    def doctor(self, *arguments):
        """Exit code and findings by subject; what of the machine is wrong depends on the machine."""
        done = subprocess.run([os.environ["SLAMCTL"], "doctor", "--json", *arguments], capture_output=True, text=True,
                              timeout=120, env={**os.environ, "SLAMD_SOCKET": self.path})
        told = json.loads(done.stdout)
        self.assertEqual(done.returncode, 0 if told["right"] else 1, done.stderr)
        self.assertEqual(told["right"], all(finding["verdict"] != "wrong" for finding in told["findings"]))
        return {finding["subject"]: finding for finding in told["findings"]}

    def test_doctor_tells_of_the_machine_and_of_the_daemon(self):
        told = self.doctor()
        self.assertEqual(told["pose"]["verdict"], "right")
        self.assertIn("RLIMIT_RTPRIO", told)
        self.assertNotIn("daemon", told)

    def test_doctor_tells_of_the_machine_without_a_daemon(self):
        told = self.doctor("--socket", os.path.join(self.folder, "none.sock"))
        self.assertEqual(told["daemon"]["verdict"], "wrong")
        self.assertIn("kernel", told)
        self.assertNotIn("pose", told)
        self.slamctl("doctor", "--lidar", "nonsense", code=2)

    def test_exit_codes_say_what_went_wrong(self):
        self.slamctl(code=2)
        self.slamctl("map", "save", "map.txt", code=2)
        self.slamctl("map", "save", os.path.join(self.folder, "none", "map.pcd"), code=1)
        self.slamctl("status", "--socket", os.path.join(self.folder, "none.sock"), code=3)
        self.assertIn("Exit codes", self.slamctl("--help"))


if __name__ == "__main__":
    unittest.main()
