"""The real imu-flash against a board on a fake USB: runs under umockdev-wrapper, IMU_FLASH names the program."""
import os
import subprocess
import tempfile
import threading
import unittest

from imu_board import ImuBoard
from rp2040_boot_loader import BootLoader, ERASE, FLASH, FlashChip, READ, REBOOT, WRITE
from uf2_file import firmware, uf2
from usb_bus import Bus

PROGRAM = os.environ["IMU_FLASH"]
REENUMERATION_S = 0.3
PORT = "2"


class Board:
    """One physical board at a port: flash chip, and the two faces that it has on the USB."""

    def __init__(self, bus, port=PORT, serial="E6616407E3554C29", content=b""):
        self.bus, self.port = bus, port
        self.chip = FlashChip(content)
        self.boot_loader = BootLoader(self.chip)
        self.imu = ImuBoard(serial)
        self.boot_loader.on_reboot = lambda: self.later(self.start)
        self.imu.on_boot_loader = lambda: self.later(lambda: bus.replug(port, self.boot_loader))

    def start(self):
        """Power-on: the ROM decides by the flash."""
        self.bus.replug(self.port, self.imu if self.chip.starts() else self.boot_loader)

    @staticmethod
    def later(action):
        timer = threading.Timer(REENUMERATION_S, action)
        timer.daemon = True
        timer.start()


class FlashTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.bus = Bus()
        self.old, self.new = firmware(seed=3), firmware(size=9000, seed=5)

    def board(self, running=True, **arguments):
        board = Board(self.bus, content=self.old if running else b"", **arguments)
        board.start()
        return board

    def file(self, content, name="firmware.uf2"):
        path = os.path.join(self.folder.name, name)
        with open(path, "wb") as file:
            file.write(content)
        return path

    def run_flash(self, *arguments, **options):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=60, check=False,
                              env=self.bus.environment, **options)

    def assert_flashed(self, board, run):
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(bytes(board.chip.bytes[: len(self.new)]), self.new)
        self.assertEqual(board.boot_loader.violations, [])

    def assert_boot_loader_left(self, board, run):
        """After a failure the chip must not start, and the text must say what to do."""
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertFalse(board.chip.starts())
        self.assertIn("boot loader", run.stderr)
        self.assertIn("run the same command once more", run.stderr)
        self.assertEqual(board.boot_loader.violations, [])


class NormalTest(FlashTest):
    def test_a_board_in_the_boot_loader_is_flashed_started_and_measured(self):
        board = self.board(running=False)
        run = self.run_flash(self.file(uf2(self.new)))
        self.assert_flashed(board, run)
        self.assertRegex(run.stdout, r"firmware 1\.2\.3, serial E6616407E3554C29: 20[78]\.\d Hz")
        for step in ("erase", "write", "verify"):
            self.assertRegex(run.stderr, step + r" +\[#+\] 100 %")

    def test_a_board_that_runs_our_firmware_is_sent_to_the_boot_loader_first(self):
        board = self.board()
        run = self.run_flash(self.file(uf2(self.new)))
        self.assert_flashed(board, run)
        self.assertIn("going to its boot loader", run.stdout)
        self.assertIn("Hz", run.stdout)

    def test_the_page_that_the_chip_starts_from_is_erased_first_and_written_last(self):
        board = self.board(running=False)
        self.run_flash(self.file(uf2(self.new)))
        erased = [address for command, address in board.boot_loader.commands if command == ERASE]
        written = [address for command, address in board.boot_loader.commands if command == WRITE]
        self.assertEqual(erased[0], FLASH)
        self.assertEqual(written[-1], FLASH)
        self.assertEqual(written.count(FLASH), 1)

    def test_a_raw_binary_is_written_with_bin(self):
        board = self.board(running=False)
        self.assert_flashed(board, self.run_flash("--bin", self.file(self.new, "firmware.bin")))

    def test_verify_compares_changes_nothing_and_starts_the_board_again(self):
        board = self.board()
        run = self.run_flash("--verify", self.file(uf2(self.old)))
        self.assertEqual(run.returncode, 0, run.stderr)
        run = self.run_flash("--verify", self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 1)
        self.assertIn("verify failed at 0x10000000", run.stderr)
        self.assertEqual(bytes(board.chip.bytes[: len(self.old)]), self.old)
        self.assertEqual([c for c, _ in board.boot_loader.commands if c in (ERASE, WRITE)], [])
        self.assertIn(REBOOT, [c for c, _ in board.boot_loader.commands])

    def test_several_boards_ask_for_a_serial_number_and_the_chosen_one_is_flashed(self):
        first, second = self.board(port="1", serial="AAAA"), self.board(port="3", serial="BBBB")
        run = self.run_flash(self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 1)
        self.assertIn("--serial", run.stderr)
        self.assertIn("AAAA", run.stderr)
        self.assertIn("BBBB", run.stderr)
        self.assert_flashed(second, self.run_flash("--serial", "BBBB", self.file(uf2(self.new))))
        self.assertEqual(bytes(first.chip.bytes[: len(self.old)]), self.old)

    def test_boards_in_the_boot_loader_are_told_apart_by_port(self):
        first, second = self.board(running=False, port="1"), self.board(running=False, port="3")
        self.assertEqual(self.run_flash(self.file(uf2(self.new))).returncode, 1)
        self.assert_flashed(second, self.run_flash("--serial", "1-3", self.file(uf2(self.new))))
        self.assertEqual(first.boot_loader.commands, [])

    def test_list_shows_boards_and_their_state(self):
        self.assertIn("no board found", self.run_flash("--list").stdout)
        self.board(port="1", serial="AAAA")
        self.board(running=False, port="3")
        lines = self.run_flash("--list").stdout.splitlines()
        self.assertEqual(len(lines), 2)
        self.assertRegex(lines[0], r"1-1 .*slamd IMU 1\.0\.2 .*AAAA")
        self.assertRegex(lines[1], r"1-3 .*boot loader")


class FaultTest(FlashTest):
    def test_a_stall_is_told_with_the_boot_loaders_reason(self):
        for command, word in ((ERASE, "erase"), (WRITE, "write"), (READ, "read")):
            with self.subTest(word):
                board = self.board(running=False)
                board.boot_loader.stall_on = command
                run = self.run_flash(self.file(uf2(self.new)))
                self.assert_boot_loader_left(board, run)
                self.assertRegex(run.stderr, word + r" at 0x1000\w+: stall \(boot loader: unknown error\)")

    def test_a_flipped_bit_fails_the_verification_and_names_the_address(self):
        for address in (FLASH + 0x1234, FLASH + 0x10):
            with self.subTest(hex(address)):
                board = self.board(running=False)
                board.boot_loader.flip_at = address
                run = self.run_flash(self.file(uf2(self.new)))
                self.assert_boot_loader_left(board, run)
                self.assertIn(f"verify failed at {address:#010x}", run.stderr)

    def test_silence_ends_in_a_timeout(self):
        board = self.board(running=False)
        board.boot_loader.silent_on = WRITE
        run = self.run_flash(self.file(uf2(self.new)))
        self.assert_boot_loader_left(board, run)
        self.assertIn("timeout", run.stderr)

    def test_unplugging_in_the_middle_leaves_a_board_that_can_be_flashed_again(self):
        board = self.board()

        def unplug(command, address):
            if command == WRITE and address > FLASH + 4096 and PORT in self.bus.plugged:
                self.bus.unplug(PORT)

        board.boot_loader.before = unplug
        run = self.run_flash(self.file(uf2(self.new)))
        self.assert_boot_loader_left(board, run)
        self.assertIn("unplugged", run.stderr)
        board.boot_loader.before = lambda command, address: None
        board.boot_loader._restart()
        board.start()  # plugged in again
        self.assert_flashed(board, self.run_flash(self.file(uf2(self.new))))

    def test_a_board_that_does_not_go_to_its_boot_loader_is_told(self):
        board = self.board()
        board.imu.ignores_reset = True
        run = self.run_flash(self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 1)
        self.assertIn("did not come back as boot loader", run.stderr)
        self.assertIn("--rescue", run.stderr)
        self.assertTrue(board.chip.starts())

    def test_a_board_that_sends_nothing_after_flashing_is_told(self):
        board = self.board(running=False)
        board.imu.mute = True
        run = self.run_flash(self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 1)
        self.assertIn("sends no samples", run.stderr)

    def test_no_permission_names_the_udev_rule(self):
        self.board(running=False)
        node = self.bus.node_file("/dev/bus/usb/001/%03d" % (self.bus.next_number - 1))
        if os.getuid() == 0:  # nobody may use the test bed, but not open the device
            for folder, _, files in os.walk(self.bus.testbed.get_root_dir()):
                os.chmod(folder, 0o777)
                for name in files:
                    os.chmod(os.path.join(folder, name), 0o666)
        os.chmod(node, 0)
        other = {"user": 65534, "group": 65534} if os.getuid() == 0 else {}
        os.chmod(self.folder.name, 0o755)
        run = self.run_flash(self.file(uf2(self.new)), **other)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertIn("no permission", run.stderr)
        self.assertIn("60-slamd.rules", run.stderr)

    def test_no_board_is_told(self):
        run = self.run_flash(self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 1)
        self.assertIn("no board found", run.stderr)


class FileTest(FlashTest):
    def assert_refused(self, content, words, *options):
        board = self.board()
        run = self.run_flash(*options, self.file(content))
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertIn(words, run.stderr)
        self.assertEqual(board.boot_loader.commands, [])
        self.assertIs(self.bus.plugged[PORT][0], board.imu)  # not even sent to the boot loader
        self.bus.unplug(PORT)

    def test_bad_files_are_refused_before_the_board_is_touched(self):
        good = self.new
        for content, words in (
                (uf2(good, family=(2, 0xE48BFF59)), "block 2: wrong family id 0xe48bff59"),
                (uf2(good, flags=(1, 0)), "block 1: names no family"),
                (uf2(good, address=(4, FLASH + 0x100)), "block 4: overlaps block 1"),
                (uf2(good, address=(4, 0x20000000)), "block 4: address 0x20000000 is outside"),
                (uf2(good, address=(4, FLASH + 0x401)), "not a multiple of 256"),
                (uf2(good, number=(3, 2)), "block number 2 comes twice"),
                (uf2(good, count=(0, 99)), "says the file has 99 blocks"),
                (uf2(good, size=(0, 476)), "payload of 476 bytes"),
                (uf2(good, magic=(0, 0)), "wrong magic number"),
                (uf2(good)[:-100], "truncated"),
                (uf2(good)[:-512], "truncated"),
                (b"", "empty")):
            with self.subTest(words):
                self.assert_refused(content, words)

    def test_info_describes_a_good_file_and_refuses_a_bad_one(self):
        run = self.run_flash("--info", self.file(uf2(self.new)))
        self.assertEqual(run.returncode, 0)
        self.assertIn("0x10000000 .. 0x100023ff", run.stdout)
        self.assertIn("valid", run.stdout)
        self.assertEqual(self.run_flash("--info", self.file(b"x" * 512)).returncode, 2)

    def test_rescue_and_help_say_how(self):
        self.assertIn("reset button twice", self.run_flash("--rescue").stdout)
        self.assertIn("exit codes", self.run_flash("--help").stdout)
        self.assertEqual(self.run_flash().returncode, 2)


if __name__ == "__main__":
    unittest.main()
