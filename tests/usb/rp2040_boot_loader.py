"""The RP2040's boot loader on USB, as its data sheet (2.8.5) describes PICOBOOT, with a flash chip behind it. Strict: what
the data sheet forbids ends in a stall with the status that it names, and is kept in `violations`.
"""
import struct

from usb_bus import UsbModel, interface
from usbfs import Stall

FLASH, FLASH_BYTES, SECTOR, PAGE = 0x10000000, 16 << 20, 4096, 256
OUT, IN = 0x03, 0x84
OK, UNKNOWN_COMMAND, BAD_LENGTH, BAD_TRANSFER, BAD_ADDRESS, BAD_ALIGNMENT = range(6)
UNKNOWN_ERROR = 8
EXCLUSIVE, REBOOT, ERASE, READ, WRITE, EXIT_XIP = 0x01, 0x02, 0x03, 0x84, 0x05, 0x06
ARGUMENT_BYTES = {EXCLUSIVE: 1, REBOOT: 12, ERASE: 8, READ: 8, WRITE: 8, EXIT_XIP: 0}


class FlashChip:
    """Erases to ones, writes only zeros, as NOR flash does."""

    def __init__(self, content=b""):
        self.bytes = bytearray(b"\xff" * FLASH_BYTES)
        self.bytes[: len(content)] = content

    def erase(self, address, size):
        self.bytes[address - FLASH: address - FLASH + size] = b"\xff" * size

    def program(self, address, data):
        at = address - FLASH
        old = self.bytes[at: at + len(data)]
        self.bytes[at: at + len(data)] = bytes(a & b for a, b in zip(old, data))

    def starts(self):
        """Whether the ROM would start it: CRC-32/MPEG-2 of the second stage."""
        crc = 0xFFFFFFFF
        for byte in self.bytes[:252]:
            crc ^= byte << 24
            for _ in range(8):
                crc = ((crc << 1) ^ (0x04C11DB7 if crc & 0x80000000 else 0)) & 0xFFFFFFFF
        return crc == struct.unpack_from("<I", self.bytes, 252)[0]


class BootLoader(UsbModel):
    """Faults, all off: `stall_on` a command, `silent_on` one, `flip_at` an address when it is written, `before(command,
    address)` called before each."""

    vendor, product = 0x2E8A, 0x0003
    strings = ("Raspberry Pi", "RP2 Boot", "E0C9125B0D9B")  # the same of every chip
    interfaces = interface(0, 0x08, 0x06, 0x50, ((0x81, 2), (0x02, 2))) + interface(1, 0xFF, 0, 0, ((IN, 2), (OUT, 2)))
    interface_count = 2
    number = 1

    def __init__(self, chip):
        super().__init__()
        self.chip = chip
        self.violations = []
        self.commands = []
        self.stall_on = self.silent_on = self.flip_at = None
        self.before = lambda command, address: None
        self.on_reboot = lambda: None
        self._restart()

    def _restart(self):
        self.halted = self.exclusive = self.flash_is_plain = False
        self.expected_out = None  # (address, bytes still to come) of a WRITE
        self.answers = []  # what the IN endpoint has to say
        self.expects_empty_out = False
        self.status = (0, OK, 0)

    def request(self, kind, request, value, index, data):
        if (kind, request, value, index) == (0x41, 0x41, 0, self.number):
            self._restart()
            return b""
        if (kind, request, value, index) == (0xC1, 0x42, 0, self.number) and len(data) == 16:
            token, code, command = self.status
            return struct.pack("<IIBB6x", token, code, command, 0)
        self.violations.append(f"control request {kind:#x} {request:#x} {value:#x} {index}")
        raise Stall()

    def clear_halt(self, endpoint):
        """The host may clear the halt; the command stays failed until the interface is reset."""

    def _refuse(self, code, why):
        self.violations.append(why)
        self._stall(code)

    def _stall(self, code):
        self.halted = True
        self.status = (self.status[0], code, self.status[2])
        raise Stall()

    def bulk_out(self, endpoint, data):
        if endpoint != OUT or self.halted:
            raise Stall()
        if self.answers == ["silence"]:
            return None
        if self.expected_out is not None:
            return self._take_data(data)
        if self.expects_empty_out:
            if data:
                self._refuse(UNKNOWN_ERROR, "a command before the acknowledgement of a read")
            self.expects_empty_out = False
            return 0
        if self.answers:
            self._refuse(UNKNOWN_ERROR, "a command before the answer to the last was taken")
        self._command(data)
        return len(data)

    def bulk_in(self, endpoint, room):
        if endpoint != IN or self.halted:
            raise Stall()
        if not self.answers or self.answers == ["silence"]:
            return None
        answer = self.answers.pop(0)
        if len(answer) > room:
            self._refuse(UNKNOWN_ERROR, "an answer that does not fit: the host would see an overflow")
        return answer

    def _command(self, data):
        if len(data) != 32:
            self._refuse(BAD_LENGTH, f"a command of {len(data)} bytes")
        magic, token, command, size, reserved, transfer, a, b, c, d = struct.unpack("<IIBBHIIIII", data)
        self.status = (token, OK, command)
        if magic != 0x431FD10B or reserved != 0 or d != 0:
            self._refuse(UNKNOWN_ERROR, "magic number or reserved field")
        if command not in ARGUMENT_BYTES:
            self._refuse(UNKNOWN_COMMAND, f"command {command:#x}")
        if size != ARGUMENT_BYTES[command]:
            self._refuse(BAD_LENGTH, f"command {command:#x} with {size} bytes of arguments")
        self.commands.append((command, a))
        self.before(command, a)
        if self.gone:
            return
        if command == self.stall_on:
            self._stall(UNKNOWN_ERROR)
        if command == self.silent_on:
            self.answers = ["silence"]
            return
        self._execute(command, transfer, a, b)

    def _execute(self, command, transfer, a, b):
        if command in (READ, WRITE) and transfer != b or command not in (READ, WRITE) and transfer != 0:
            self._refuse(BAD_TRANSFER, f"command {command:#x} with a transfer of {transfer}")
        if command in (ERASE, READ, WRITE):
            self._check_range(command, a, b)
        if command == EXCLUSIVE:
            self.exclusive = a in (1, 2)
        elif command == EXIT_XIP:
            self.flash_is_plain = True
        elif command == ERASE:
            self.chip.erase(a, b)
        elif command == WRITE:
            self.expected_out = [a, b]
            return
        elif command == READ:
            self.answers = [bytes(self.chip.bytes[a - FLASH: a - FLASH + b])]
            self.expects_empty_out = True
            return
        elif command == REBOOT:
            if a != 0:
                self._refuse(BAD_ADDRESS, "reboot into memory")
            self.on_reboot()
        self.answers = [b""]

    def _check_range(self, command, address, size):
        if not FLASH <= address or address + size > FLASH + FLASH_BYTES or size == 0:
            self._refuse(BAD_ADDRESS, f"{command:#x} at {address:#x}")
        unit = SECTOR if command == ERASE else PAGE if command == WRITE else 1
        if address % unit or size % unit:
            self._refuse(BAD_ALIGNMENT, f"{command:#x} at {address:#x} of {size}")
        if not self.flash_is_plain or not self.exclusive:
            self._refuse(UNKNOWN_ERROR, f"{command:#x} before exit XIP or without exclusive access")

    def _take_data(self, data):
        address, left = self.expected_out
        if not data or len(data) > left:
            self._refuse(BAD_TRANSFER, f"{len(data)} bytes where {left} were announced")
        data = bytearray(data)
        if self.flip_at is not None and address <= self.flip_at < address + len(data):
            data[self.flip_at - address] ^= 0x10
        self.chip.program(address, data)
        self.expected_out = [address + len(data), left - len(data)] if left > len(data) else None
        if self.expected_out is None:
            self.answers = [b""]
        return len(data)
