"""Packets of the IMU board, packed from firmware/protocol/README.md and not with the code under test."""
import struct

GRAVITY_LSB = 8197  # 1 g at 0.122 mg/LSB


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
    return crc


def cobs(data):
    out, block = bytearray(), bytearray()
    for byte in data + b"\0":
        if byte:
            block.append(byte)
        else:
            out += bytes([len(block) + 1]) + block
            block.clear()
    return bytes(out)


def packet(body):
    return cobs(body + struct.pack("<H", crc16(body))) + b"\0"


def identity(tag, unique_id, version):
    return packet(struct.pack("<BBH8s3BBHHBB", 0x21, 0x6C, tag, unique_id, *version, 2, 208, 500, 4, 0))


def frame(sequence, device_us, status=0, gyro=(0, 0, 0), accel=(0, 0, GRAVITY_LSB), dropped=0):
    return packet(struct.pack("<BBHQ3h3hhH", 0x11, status, sequence & 0xFFFF, device_us, *gyro, *accel, 0, dropped))
