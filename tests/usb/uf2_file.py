"""UF2 files for the tests: right ones, and with any field of any block made wrong."""
import struct

FLASH, FAMILY = 0x10000000, 0xE48BFF56


def second_stage(seed=1):
    """252 bytes and the CRC that the ROM wants."""
    code = bytes((i * 7 + seed) & 0xFF for i in range(252))
    crc = 0xFFFFFFFF
    for byte in code:
        crc ^= byte << 24
        for _ in range(8):
            crc = ((crc << 1) ^ (0x04C11DB7 if crc & 0x80000000 else 0)) & 0xFFFFFFFF
    return code + struct.pack("<I", crc)


def firmware(size=9000, seed=1):
    return second_stage(seed) + bytes((i * i * 31 + i // 256 + seed) & 0xFF for i in range(size - 256))


def uf2(image, **wrong):
    """wrong: field=(block, value) with field of flags, address, size, number, count, family, magic."""
    image = image + b"\xff" * (-len(image) % 256)
    count = len(image) // 256
    out = b""
    for i in range(count):
        field = {"magic": 0x0A324655, "flags": 0x2000, "address": FLASH + 256 * i, "size": 256, "number": i,
                 "count": count, "family": FAMILY}
        field.update({name: value for name, (block, value) in wrong.items() if block == i})
        out += struct.pack("<8I", field["magic"], 0x9E5D5157, field["flags"], field["address"], field["size"],
                           field["number"], field["count"], field["family"])
        out += image[256 * i: 256 * i + 256].ljust(476, b"\0") + struct.pack("<I", 0x0AB16F30)
    return out
