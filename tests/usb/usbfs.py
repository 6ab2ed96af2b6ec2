"""A USB device as the kernel's usbfs shows it to libusb: answers the ioctls of one device node from a device model.

It knows URBs and no device. The model is any object with
    control(setup: bytes, data: bytes) -> bytes      answer of endpoint 0; raise Stall
    bulk_out(endpoint, data: bytes) -> int           bytes taken; raise Stall; None = not yet (NAK)
    bulk_in(endpoint, room: int) -> bytes            answer; raise Stall; None = not yet (NAK)
    clear_halt(endpoint)                             and an attribute `gone` once it is unplugged
"""
import errno
import struct
import threading
import time

import gi

gi.require_version("UMockdev", "1.0")
from gi.repository import UMockdev  # noqa: E402

URB = struct.Struct("<BB2xiI4xQiiiiiIQ")  # struct usbdevfs_urb on a 64-bit machine
STATUS_AT, ACTUAL_LENGTH_AT, BUFFER_AT = 4, 28, 16
CONTROL, BULK = 2, 3


def _ior(number, size):
    return 2 << 30 | size << 16 | ord("U") << 8 | number


def _iow(number, size):
    return 1 << 30 | size << 16 | ord("U") << 8 | number


SUBMIT, DISCARD = _ior(10, URB.size), ord("U") << 8 | 11
REAP, REAP_NOW = _iow(12, 8), _iow(13, 8)
CAPABILITIES, CLEAR_HALT, IOCTL = _ior(26, 4), _ior(21, 4), 3 << 30 | 16 << 16 | ord("U") << 8 | 18
GET_DRIVER = _iow(8, 260)
ACCEPTED = {_ior(15, 4), _ior(16, 4), _ior(5, 4), ord("U") << 8 | 20}  # claim, release, set configuration, reset


class Stall(Exception):
    """The endpoint answers STALL."""


class Urb:
    """One URB of the client, with its memory there."""

    def __init__(self, arg):
        self.memory = arg.resolve(0, URB.size)
        fields = URB.unpack(bytes(self.memory.retrieve()))
        self.kind, self.endpoint, self.length = fields[0], fields[1], fields[5]
        self.buffer = self.memory.resolve(BUFFER_AT, self.length) if self.length else None
        self.bytes = bytes(self.buffer.retrieve()) if self.buffer else b""

    @property
    def address(self):
        return self.memory.client_addr

    def finish(self, status, actual=0, answer=b"", at=0):
        if answer:
            self.buffer.update(at, answer)
        self.memory.update(STATUS_AT, struct.pack("<i", status))
        self.memory.update(ACTUAL_LENGTH_AT, struct.pack("<i", actual))


class UsbfsNode:
    """Serves one device node; `attach` it to a testbed. umockdev calls from a thread of its own."""

    IDLE_S = 0.0005  # libusb polls a node that is always ready: this keeps both sides from spinning

    def __init__(self, device):
        self.device = device
        self.lock = threading.Lock()
        self.waiting = []
        self.done = []
        self.handler = UMockdev.IoctlBase.new()
        self.handler.connect("handle-ioctl", self._on_ioctl)

    def attach(self, testbed, node):
        testbed.attach_ioctl(node, self.handler)

    def _on_ioctl(self, _handler, client):
        try:
            with self.lock:
                result, error = self._answer(client.get_request() & 0xFFFFFFFF, client.get_arg())
        except Exception as fault:  # a fault of the fake must not hang the program under test
            print("usbfs fake:", repr(fault), flush=True)
            result, error = -1, errno.EIO
        client.complete(result, error)
        return True

    def _answer(self, request, arg):
        if self.device.gone and request not in (REAP, REAP_NOW, DISCARD):
            return -1, errno.ENODEV
        if request == CAPABILITIES:
            arg.resolve(0, 4).update(0, struct.pack("<I", 0))
        elif request == SUBMIT:
            self.waiting.append(Urb(arg))
        elif request in (REAP, REAP_NOW):
            return self._reap(arg)
        elif request == DISCARD:
            return self._discard(struct.unpack("<Q", bytes(arg.retrieve()))[0])
        elif request == CLEAR_HALT:
            self.device.clear_halt(struct.unpack("<I", bytes(arg.resolve(0, 4).retrieve()))[0])
        elif request in (GET_DRIVER, IOCTL):
            return -1, errno.ENODATA  # no kernel driver on any interface
        elif request not in ACCEPTED:
            return -1, errno.ENOTTY
        return 0, 0

    def _reap(self, arg):
        self._progress()
        if not self.done:
            if self.device.gone:
                return -1, errno.ENODEV
            time.sleep(self.IDLE_S)
            return -1, errno.EAGAIN
        arg.resolve(0, 8).set_ptr(0, self.done.pop(0).memory)
        return 0, 0

    def _discard(self, address):
        for urb in self.waiting:
            if urb.address == address:
                self.waiting.remove(urb)
                urb.finish(-errno.ENOENT)
                self.done.append(urb)
                return 0, 0
        return -1, errno.EINVAL

    def _progress(self):
        """Gives each endpoint's oldest waiting URB to the device, until it has no answer."""
        blocked = set()
        for urb in list(self.waiting):
            if urb.endpoint in blocked:
                continue
            if self._serve(urb):
                self.waiting.remove(urb)
                self.done.append(urb)
            else:
                blocked.add(urb.endpoint)

    def _serve(self, urb):
        if self.device.gone:
            urb.finish(-errno.ENODEV)
            return True
        try:
            if urb.kind == CONTROL:
                setup, data = urb.bytes[:8], urb.bytes[8:]
                answer = self.device.control(setup, data)
                inward = bool(setup[0] & 0x80)
                answer = answer[: len(data)] if inward else b""
                urb.finish(0, len(answer) if inward else len(data), answer, 8)
            elif urb.endpoint & 0x80:
                answer = self.device.bulk_in(urb.endpoint, urb.length)
                if answer is None:
                    return False
                urb.finish(0, len(answer), answer)
            else:
                taken = self.device.bulk_out(urb.endpoint, urb.bytes)
                if taken is None:
                    return False
                urb.finish(0, taken)
        except Stall:
            urb.finish(-errno.EPIPE)
        return True
