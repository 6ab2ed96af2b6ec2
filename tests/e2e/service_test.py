"""What slamd tells a service manager and takes from it, without one: notifications, watchdog, reload, descriptors."""

import array
import json
import mmap
import os
import signal
import socket
import struct
import time
import unittest

from harness import Client, EndToEndTest

STARTS_OFFSET = 16  # in the pose page: how many daemons have written it


class ServiceManager:
    """The receiving end of sd_notify(): every message with the descriptors that came along."""

    def __init__(self, path):
        self.path = path
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(path)
        self.messages = []
        self.fds = []

    def receive(self):
        self.socket.setblocking(False)
        while True:
            try:
                text, ancillary, _, _ = self.socket.recvmsg(65536, socket.CMSG_SPACE(16))
            except BlockingIOError:
                return self.messages
            self.messages.append(text.decode())
            for level, kind, content in ancillary:
                if (level, kind) == (socket.SOL_SOCKET, socket.SCM_RIGHTS):
                    self.fds += array.array("i", content[:len(content) - len(content) % 4])

    def count(self, message):
        return sum(message in told for told in self.receive())

    def close(self):
        self.socket.close()
        for fd in self.fds:
            os.close(fd)


class ServiceTest(EndToEndTest):
    def setUp(self):
        super().setUp()
        self.manager = ServiceManager(self.path("notify"))
        self.config = self.path("slamd.yaml")
        self.write("")

    def tearDown(self):
        self.manager.close()
        super().tearDown()

    def write(self, text):
        with open(self.config, "w", encoding="utf-8") as file:
            file.write(text)

    def start_service(self, *fds, names=""):
        """slamd as a service manager starts it, with these descriptors handed over."""
        passed = " ".join(f"{3 + i}<&{fd}" for i, fd in enumerate(fds))
        environment = f"LISTEN_PID=$$ LISTEN_FDS={len(fds)} LISTEN_FDNAMES={names}" if fds else ""
        script = f'{environment} NOTIFY_SOCKET={self.manager.path} WATCHDOG_USEC=8000000 exec "$@" {passed}'
        arguments = ["bash", "-c", script, "bash", *self.daemon_arguments(), "--config", self.config]
        before = self.manager.count("READY=1")
        daemon = self.start("slamd", arguments, fds=fds)
        self.await_value("READY", lambda: self.manager.count("READY=1") > before, 60.0)
        self.client = self.connect(daemon)
        self.assertIsNotNone(self.client, "READY before the socket was there")
        return daemon

    def reload(self, daemon):
        done = self.manager.count("READY=1")
        daemon.send(signal.SIGHUP)
        self.await_value("the end of the reload", lambda: self.manager.count("READY=1") > done, 30.0)

    def test_ready_comes_with_the_socket_and_the_status_says_how_all_stands(self):
        daemon = self.start_service()
        self.await_value("the status", lambda: self.manager.count("STATUS=INITIALISING; lidar absent, imu absent"), 30.0)
        self.assert_stops_cleanly(daemon)
        self.assertEqual(self.manager.receive()[-1], "STOPPING=1")

    def test_the_watchdog_is_fed_and_a_stopped_process_does_not_feed_it(self):
        daemon = self.start_service()
        self.await_value("food for the watchdog", lambda: self.manager.count("WATCHDOG=1") >= 2, 60.0)
        daemon.send(signal.SIGSTOP)
        fed = self.manager.count("WATCHDOG=1")
        time.sleep(3.0)  # it would have been fed by now
        self.assertEqual(self.manager.count("WATCHDOG=1"), fed)
        daemon.send(signal.SIGCONT)
        self.await_value("more food", lambda: self.manager.count("WATCHDOG=1") > fed, 60.0)

    def test_a_reload_takes_everything_over_or_nothing(self):
        daemon = self.start_service()
        self.write("server:\n  max_clients: 1\nlidar:\n  max_range_m: 50\n")
        self.reload(daemon)
        self.assertEqual(self.greeting(), {}, "a second client is still allowed")
        self.await_value("the reason", lambda: "lidar.max_range_m: takes a restart" in daemon.output(), 10.0)
        self.write("server:\n  max_clients: 1\n  max_cleints: 1\n")
        self.reload(daemon)
        self.await_value("the reason", lambda: "slamd.yaml:3: server.max_cleints: unknown key" in daemon.output(), 10.0)
        self.write("server:\n  max_clients: 1\n")
        self.reload(daemon)
        self.await_value("the good news", lambda: "config state=reloaded" in daemon.output(), 10.0)
        self.assertIn("error", self.greeting(), "one client is all that is allowed now")

    def greeting(self):
        """What one more client is told without asking within a second: an error where it is refused, else nothing."""
        client = Client(self.path("slamd.sock"), timeout_s=1.0)
        try:
            return json.loads(client.lines.readline())
        except socket.timeout:
            return {}
        finally:
            client.close()

    def test_a_client_that_connects_before_the_start_is_served_on_the_socket_that_was_handed_over(self):
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.addCleanup(listening.close)
        listening.bind(self.path("slamd.sock"))
        listening.listen(8)
        early = Client(self.path("slamd.sock"))
        daemon = self.start_service(listening.fileno(), names="socket")
        self.assertEqual(early.call("version")["result"]["daemon"], "slamd")
        early.close()
        self.assert_stops_cleanly(daemon)
        self.assertTrue(os.path.exists(self.path("slamd.sock")), "it is not the daemon's to remove")

    def test_mappings_of_the_pose_page_outlive_a_killed_daemon(self):
        daemon = self.start_service()
        self.await_value("the page", lambda: self.manager.receive() and self.manager.fds, 10.0)
        page = mmap.mmap(self.manager.fds[0], 4096, mmap.MAP_SHARED, mmap.PROT_READ)
        self.addCleanup(page.close)
        self.assertEqual(struct.unpack_from("<I", page, STARTS_OFFSET)[0], 1)
        self.client.close()
        daemon.send(signal.SIGKILL)
        daemon.wait(30.0)
        self.start_service(self.manager.fds[0], names="pose-page")
        self.assertEqual(struct.unpack_from("<I", page, STARTS_OFFSET)[0], 2, "the same page, taken over")


if __name__ == "__main__":
    unittest.main()
