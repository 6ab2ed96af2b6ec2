"""A USB with ports for device models: sysfs and device nodes of a umockdev test bed. Run under umockdev-wrapper."""
import atexit
import os
import shutil
import struct

from usbfs import UsbfsNode, Stall  # first: it names the version of UMockdev
from gi.repository import UMockdev

GET_DESCRIPTOR, SET_ADDRESS, SET_CONFIGURATION = 6, 5, 9
STRING = 3


class UsbModel:
    """What all device models share: identity, strings, refusal of unknown requests. `gone` is set by Bus.unplug."""

    vendor, product, release = 0, 0, 0x0100
    strings = ("slamd tests", "a device", "0")  # manufacturer, product, serial number
    interfaces = b""  # the configuration's descriptors after its own
    interface_count = 1

    def __init__(self):
        self.gone = False

    def descriptors(self):
        device = struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0200, 0, 0, 0, 64, self.vendor, self.product, self.release,
                             1, 2, 3, 1)
        config = struct.pack("<BBHBBBBB", 9, 2, 9 + len(self.interfaces), self.interface_count, 1, 0, 0x80, 50)
        return device + config + self.interfaces

    def control(self, setup, data):
        kind, request, value, index, _length = struct.unpack("<BBHHH", setup)
        if kind == 0x80 and request == GET_DESCRIPTOR and value >> 8 == STRING:
            number = value & 0xFF
            if number == 0:
                return bytes([4, STRING, 9, 4])
            text = self.strings[number - 1].encode("utf-16-le")
            return bytes([2 + len(text), STRING]) + text
        return self.request(kind, request, value, index, data)

    def request(self, kind, request, value, index, data):
        raise Stall()

    def bulk_out(self, endpoint, data):
        raise Stall()

    def bulk_in(self, endpoint, room):
        raise Stall()

    def clear_halt(self, endpoint):
        pass


def interface(number, class_code, subclass, protocol, endpoints=()):
    text = struct.pack("<9B", 9, 4, number, 0, len(endpoints), class_code, subclass, protocol, 0)
    for address, kind in endpoints:
        text += struct.pack("<BBBBHB", 7, 5, address, kind, 64 if kind == 2 else 16, 0 if kind == 2 else 10)
    return text


class Bus:
    """One bus; a device gets a new number each time it is plugged in, as on a real one."""

    def __init__(self):
        self.testbed = UMockdev.Testbed.new()
        atexit.register(shutil.rmtree, self.testbed.get_root_dir(), ignore_errors=True)
        self.next_number = 2
        self.plugged = {}  # port -> (device, sysfs path)

    @property
    def environment(self):
        return {**os.environ, "UMOCKDEV_DIR": self.testbed.get_root_dir()}

    def plug(self, port, device):
        number = self.next_number
        self.next_number += 1
        node = f"/dev/bus/usb/001/{number:03d}"
        device.gone = False
        path = f"/devices/pci0000:00/usb1/1-{port}"
        # The node's answers come first: who finds a node without them is ended by umockdev.
        UsbfsNode(device).attach(self.testbed, node)
        self.testbed.add_from_string(
            f"P: {path}\nN: bus/usb/001/{number:03d}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DEVNAME={node}\n"
            f"E: BUSNUM=001\nE: DEVNUM={number:03d}\nA: busnum=1\\n\nA: devnum={number}\\n\nA: speed=12\\n\n"
            f"A: bConfigurationValue=1\\n\nH: descriptors={device.descriptors().hex().upper()}\n")
        self.plugged[port] = (device, "/sys" + path)
        return self.node_file(node)

    def unplug(self, port):
        device, path = self.plugged.pop(port)
        device.gone = True
        self.testbed.remove_device(path)

    def replug(self, port, device):
        """The same port, another face: what a reboot of the board does."""
        if port in self.plugged:
            self.unplug(port)
        self.plug(port, device)

    def node_file(self, node):
        """The file behind a device node."""
        return self.testbed.get_root_dir() + node
