"""The IMU board running our firmware, as the host sees it on USB: CDC data endpoint with frames, vendor reset interface."""
import struct
import time

from imu_frames import frame, identity, packet
from usb_bus import UsbModel, interface
from usbfs import Stall

CDC_CONTROL, CDC_DATA, RESET = 0, 1, 2
NOTIFY, OUT, IN = 0x81, 0x02, 0x82


class ImuBoard(UsbModel):
    """Sends frames at `rate_hz` once DTR is raised, in device time that starts with the object."""

    vendor, product, release = 0x1209, 0x0001, 0x0102
    interfaces = (interface(CDC_CONTROL, 0x02, 0x02, 0x00, ((NOTIFY, 3),)) +
                  interface(CDC_DATA, 0x0A, 0x00, 0x00, ((IN, 2), (OUT, 2))) + interface(RESET, 0xFF, 0x00, 0x01))
    interface_count = 3

    def __init__(self, serial="E6616407E3554C29", rate_hz=208.0):
        super().__init__()
        self.strings = ("slamd", "slamd IMU", serial)
        self.rate_hz = rate_hz
        self.status = 0
        self.mute = False
        self.listening = False
        self.ignores_reset = False
        self.on_boot_loader = lambda: None
        self.start = time.monotonic()
        self.sequence = None  # of the last frame sent
        self.skip = set()  # sequence numbers that are lost on the way
        self.answers = []  # replies to commands, sent before the next frame

    def request(self, kind, request, value, index, data):
        if (kind, request, index) == (0x21, 0x22, CDC_CONTROL):
            self.listening = bool(value & 1)
            return b""
        if (kind, request, index) == (0x21, 0x20, CDC_CONTROL):
            return b""
        if (kind, request, value, index) == (0x21, 1, 0, RESET):
            if not self.ignores_reset:
                self.on_boot_loader()
            return b""
        raise Stall()

    def bulk_out(self, endpoint, data):
        command = struct.pack("<BBH", 0x81, 1, 1)  # identity, tag 1: the only one that is sent here
        if data != packet(command):
            raise Stall()
        self.answers.append(identity(1, bytes.fromhex(self.strings[2].rjust(16, "0")), (1, 2, 3)))
        return len(data)

    def bulk_in(self, endpoint, room):
        """The next frame when its time has come; frames that nobody fetched in time are dropped, as the board does."""
        if self.mute or not self.listening:
            return None
        if self.answers:
            return self.answers.pop(0)
        due = int((time.monotonic() - self.start) * self.rate_hz)
        if self.sequence is None or due - self.sequence > 64:
            self.sequence = due - 1
        while self.sequence < due:
            self.sequence += 1
            if self.sequence not in self.skip:
                return frame(self.sequence, int(self.sequence * 1e6 / self.rate_hz), self.status)
        return None
