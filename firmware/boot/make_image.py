#!/usr/bin/env python3
"""Finishes the linked firmware: CRC of the second stage into the ELF file, then the flash image as .bin and as .uf2.

usage: make_image.py IN.elf OUT.elf OUT.bin OUT.uf2

The RP2040's ROM runs the second stage only when bytes 252..255 of the flash hold the CRC-32 of bytes 0..251 (polynomial
0x04C11DB7, start 0xFFFFFFFF, not reflected, no final xor; data sheet 2.8.1.3.1). Same input, same bytes.
"""
import struct
import sys

FLASH_BASE = 0x10000000
SECOND_STAGE_BYTES = 256
UF2_PAYLOAD = 256
UF2_MAGIC_0, UF2_MAGIC_1, UF2_MAGIC_END = 0x0A324655, 0x9E5D5157, 0x0AB16F30
UF2_FLAG_FAMILY = 0x00002000
UF2_FAMILY_RP2040 = 0xE48BFF56


def second_stage_crc(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte << 24
        for _ in range(8):
            crc = (crc << 1) ^ (0x04C11DB7 if crc & 0x80000000 else 0)
            crc &= 0xFFFFFFFF
    return crc


def flash_segments(elf):
    """(file offset, flash address, size) of what the ELF file loads into flash."""
    if elf[:6] != b"\x7fELF\x01\x01":
        raise ValueError("not a little-endian ELF file of 32 bits")
    table, = struct.unpack_from("<I", elf, 28)
    entry_bytes, entries = struct.unpack_from("<HH", elf, 42)
    segments = []
    for i in range(entries):
        kind, offset, _, address, size = struct.unpack_from("<5I", elf, table + i * entry_bytes)
        if kind == 1 and size > 0:  # PT_LOAD with bytes in the file
            segments.append((offset, address, size))
    return sorted(segments, key=lambda segment: segment[1])


def flash_image(elf):
    """The bytes from the start of flash, gaps and the last page filled with 0xFF as in erased flash."""
    image = bytearray()
    for offset, address, size in flash_segments(elf):
        at = address - FLASH_BASE
        if at < len(image):
            raise ValueError(f"segment at {address:#x} is outside the flash or overlaps another")
        image.extend(b"\xff" * (at - len(image)))
        image.extend(elf[offset:offset + size])
    image.extend(b"\xff" * (-len(image) % UF2_PAYLOAD))
    return image


def write_crc(elf):
    offset, address, size = flash_segments(elf)[0]
    if address != FLASH_BASE or size < SECOND_STAGE_BYTES:
        raise ValueError("the first segment is not the second stage")
    crc = second_stage_crc(elf[offset:offset + SECOND_STAGE_BYTES - 4])
    struct.pack_into("<I", elf, offset + SECOND_STAGE_BYTES - 4, crc)


def uf2(image):
    blocks = len(image) // UF2_PAYLOAD
    out = bytearray()
    for i in range(blocks):
        out += struct.pack("<8I", UF2_MAGIC_0, UF2_MAGIC_1, UF2_FLAG_FAMILY, FLASH_BASE + i * UF2_PAYLOAD, UF2_PAYLOAD,
                           i, blocks, UF2_FAMILY_RP2040)
        out += image[i * UF2_PAYLOAD:(i + 1) * UF2_PAYLOAD].ljust(476, b"\0")
        out += struct.pack("<I", UF2_MAGIC_END)
    return out


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    linked, *outputs = sys.argv[1:]
    with open(linked, "rb") as file:
        elf = bytearray(file.read())
    write_crc(elf)
    image = flash_image(elf)
    for path, content in zip(outputs, (elf, image, uf2(image))):
        with open(path, "wb") as file:
            file.write(content)


if __name__ == "__main__":
    main()
