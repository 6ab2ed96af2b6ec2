"""The files for the board: CRC of the second stage, UF2, sizes, and that a build elsewhere gives the same bytes."""
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "firmware" / "boot"))
sys.dont_write_bytecode = True
import make_image  # noqa: E402  (from firmware/boot)

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(slamd LANGUAGES NONE)
include(firmware/image.cmake)
"""


def build(folder):
    """Builds the image from a copy of the sources in `folder`; returns the paths of .elf, .bin and .uf2."""
    shutil.copytree(ROOT / "firmware", folder / "firmware")
    (folder / "CMakeLists.txt").write_text(PROJECT, encoding="utf-8")
    output = folder / "out"
    for command in (["cmake", "-G", "Ninja", "-S", folder, "-B", output],
                    ["cmake", "--build", output, "--target", "firmware"]):
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise AssertionError(run.stdout + run.stderr)
    return [output / f"slamd-imu.{suffix}" for suffix in ("elf", "bin", "uf2")]


@unittest.skipUnless(shutil.which("arm-none-eabi-g++"), "no arm-none-eabi-g++")
class ImageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name)
        (root / "a").mkdir()
        (root / "b-with-a-longer-name").mkdir()
        cls.first = [path.read_bytes() for path in build(root / "a")]
        cls.second = [path.read_bytes() for path in build(root / "b-with-a-longer-name")]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_two_builds_in_two_folders_give_the_same_bytes(self):
        for name, first, second in zip(("elf", "bin", "uf2"), self.first, self.second):
            self.assertTrue(first == second, f"slamd-imu.{name} differs")

    def test_second_stage_ends_with_its_crc(self):
        image = self.first[1]
        self.assertEqual(struct.unpack_from("<I", image, 252)[0], make_image.second_stage_crc(image[:252]))

    def test_vector_table_has_a_stack_in_ram_and_an_entry_in_flash(self):
        stack, entry = struct.unpack_from("<II", self.first[1], 256)
        self.assertEqual(stack, 0x20042000)
        self.assertTrue(0x10000100 < entry < 0x10001000)
        self.assertEqual(entry & 1, 1, "Thumb")

    def test_image_is_small(self):
        self.assertLess(len(self.first[1]), 16 * 1024)

    def test_uf2_holds_the_image_block_by_block(self):
        _, image, uf2 = self.first
        self.assertEqual(len(uf2) % 512, 0)
        blocks = len(uf2) // 512
        self.assertEqual(blocks * 256, len(image))
        for i in range(blocks):
            block = uf2[512 * i:512 * (i + 1)]
            header = struct.unpack_from("<8I", block)
            self.assertEqual(header, (0x0A324655, 0x9E5D5157, 0x2000, 0x10000000 + 256 * i, 256, i, blocks, 0xE48BFF56))
            self.assertTrue(block[32:288] == image[256 * i:256 * (i + 1)], f"block {i}")
            self.assertEqual(struct.unpack_from("<I", block, 508)[0], 0x0AB16F30)

    def test_elf_and_bin_hold_the_same(self):
        elf, image, _ = self.first
        self.assertTrue(make_image.flash_image(elf) == image)

    def test_no_path_of_the_build_machine_is_in_the_files(self):
        for content in self.first:
            self.assertEqual(content.find(os.fsencode(self.folder.name)), -1)


class CrcTest(unittest.TestCase):
    def test_crc_has_the_check_value_of_crc32_mpeg2(self):
        self.assertEqual(make_image.second_stage_crc(b"123456789"), 0x0376E6E7)

    def test_overlapping_segments_are_refused(self):
        header = bytearray(52)
        header[:6] = b"\x7fELF\x01\x01"
        struct.pack_into("<I", header, 28, 52)
        struct.pack_into("<HH", header, 42, 32, 2)
        first = struct.pack("<8I", 1, 0, 0, 0x10000000, 64, 64, 5, 4)
        second = struct.pack("<8I", 1, 0, 0, 0x10000020, 64, 64, 5, 4)
        with self.assertRaises(ValueError):
            make_image.flash_image(bytes(header) + first + second)


if __name__ == "__main__":
    unittest.main()
