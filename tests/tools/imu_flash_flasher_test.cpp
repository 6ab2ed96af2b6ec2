// Flasher and PICOBOOT client of imu-flash against a boot loader in memory: bytes of the commands, and that the board
// can be flashed again after a fault at every possible place.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/tools/uf2_bytes.hpp"
#include "tools/imu-flash/flasher.hpp"

namespace slamd::flash {
namespace {

constexpr std::size_t kChipBytes = 64 << 10;
constexpr UsbTransfer kGood{};

/// Answers as the ROM does; ends with `fault` at the transfer number `fault_at`.
class MemoryBootLoader final : public PicobootTransport {
 public:
  std::vector<std::uint8_t> chip = std::vector<std::uint8_t>(kChipBytes, 0xFF);
  std::vector<std::array<std::uint8_t, 32>> commands;
  int fault_at = -1;
  UsbFault fault = UsbFault::kStall;
  int transfers = 0;

  UsbTransfer send(std::span<const std::uint8_t> bytes, Duration) override {
    if (transfers++ == fault_at) return {fault};
    if (bytes.empty()) return kGood;
    if (writing_ > 0) {
      std::transform(bytes.begin(), bytes.end(), chip.begin() + at_, chip.begin() + at_,
                     [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a & b); });
      writing_ = 0;
      return {UsbFault::kNone, bytes.size()};
    }
    std::array<std::uint8_t, 32> command{};
    std::ranges::copy(bytes, command.begin());
    commands.push_back(command);
    execute(command);
    return {UsbFault::kNone, bytes.size()};
  }

  UsbTransfer receive(std::span<std::uint8_t> bytes, Duration) override {
    if (transfers++ == fault_at) return {fault};
    if (!reading_) return kGood;
    std::copy_n(chip.begin() + at_, bytes.size(), bytes.begin());
    reading_ = false;
    return {UsbFault::kNone, bytes.size()};
  }

  UsbTransfer reset_interface() override {
    writing_ = 0;
    reading_ = false;
    return kGood;
  }

  UsbTransfer command_status(std::span<std::uint8_t> answer) override {
    std::ranges::fill(answer, 0);
    answer[4] = 4;
    return {UsbFault::kNone, answer.size()};
  }

  std::uint32_t word(const std::array<std::uint8_t, 32>& command, std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(command[at + i]) << (8U * i);
    return value;
  }

 private:
  void execute(const std::array<std::uint8_t, 32>& command) {
    at_ = static_cast<std::ptrdiff_t>(word(command, 16) - kFlashBegin);
    if (command[8] == 0x03) std::fill_n(chip.begin() + at_, word(command, 20), std::uint8_t{0xFF});
    if (command[8] == 0x05) writing_ = word(command, 20);
    reading_ = command[8] == 0x84;
  }

  std::ptrdiff_t at_ = 0;
  std::uint32_t writing_ = 0;
  bool reading_ = false;
};

FlashImage bootable_image(std::uint8_t seed) {
  std::vector<std::uint8_t> content = test::image_bytes(9000);
  for (std::uint8_t& byte : content) byte = static_cast<std::uint8_t>(byte + seed);
  test::store_word(content, 252, test::crc32_mpeg2({content.data(), 252}));
  return image_of_binary(content).image;
}

bool holds(const MemoryBootLoader& board, const FlashImage& image) {
  return std::ranges::all_of(image.pages, [&](const Page& page) {
    return std::ranges::equal(page.bytes, std::span{board.chip}.subspan(page.address - kFlashBegin, kPageBytes));
  });
}

FlashOutcome flash(MemoryBootLoader& board, const FlashImage& image) {
  PicobootClient client{board};
  return Flasher{client, image, [](Step, std::size_t, std::size_t) { return true; }}.write();
}

TEST(PicobootClient, ACommandHasTheBytesOfTheDataSheet) {
  MemoryBootLoader board;
  PicobootClient client{board};
  ASSERT_TRUE(client.erase(0x1000'1000, 0x1000));
  ASSERT_TRUE(client.reboot(500));
  const std::array<std::uint8_t, 32> erase{0x0B, 0xD1, 0x1F, 0x43, 1,    0,    0,    0,    0x03, 8, 0, 0, 0, 0, 0, 0,
                                           0x00, 0x10, 0x00, 0x10, 0x00, 0x10, 0x00, 0x00, 0,    0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(board.commands[0], erase);
  EXPECT_EQ(board.commands[1][8], 0x02);
  EXPECT_EQ(board.commands[1][9], 12);
  EXPECT_EQ(board.word(board.commands[1], 24), 500U);
  EXPECT_EQ(board.word(board.commands[1], 4), 2U);  // a new token
}

TEST(PicobootClient, AFaultIsToldWithTheCommandTheAddressAndTheBootLoadersReason) {
  MemoryBootLoader board;
  board.fault_at = 0;
  PicobootClient client{board};
  std::array<std::uint8_t, 256> page{};
  const PicobootOutcome outcome = client.read(0x1000'0100, page);
  EXPECT_EQ(outcome.fault, UsbFault::kStall);
  EXPECT_EQ(outcome.text, "read at 0x10000100: stall (boot loader: invalid address)");
}

TEST(Flasher, WritesOverAnOldImage) {
  MemoryBootLoader board;
  ASSERT_TRUE(flash(board, bootable_image(1)));
  ASSERT_TRUE(flash(board, bootable_image(2)));
  EXPECT_TRUE(holds(board, bootable_image(2)));
}

TEST(Flasher, AFaultAtAnyTransferLeavesAChipThatDoesNotStartOrHoldsAWholeImage) {
  MemoryBootLoader clean;
  const FlashImage before = bootable_image(1);
  const FlashImage image = bootable_image(2);
  ASSERT_TRUE(flash(clean, before));
  const std::vector<std::uint8_t> old_chip = clean.chip;
  clean.transfers = 0;
  ASSERT_TRUE(flash(clean, image));
  ASSERT_GT(clean.transfers, 20);
  for (int at = 0; at < clean.transfers; ++at) {
    for (const UsbFault fault : {UsbFault::kStall, UsbFault::kTimeout, UsbFault::kGone}) {
      MemoryBootLoader board;
      board.chip = old_chip;
      board.fault_at = at;
      board.fault = fault;
      const FlashOutcome outcome = flash(board, image);
      ASSERT_FALSE(outcome) << at;
      const bool starts = image_of_binary(std::span{board.chip}.first(256)).image.is_bootable();
      ASSERT_TRUE(!starts || holds(board, before) || holds(board, image)) << "transfer " << at;
      ASSERT_TRUE(flash(board, image)) << "transfer " << at;
      ASSERT_TRUE(holds(board, image));
    }
  }
}

TEST(Flasher, StoppedByTheUserItLeavesAChipThatDoesNotStart) {
  MemoryBootLoader board;
  PicobootClient client{board};
  const FlashImage image = bootable_image(1);
  Flasher flasher{client, image, [](Step step, std::size_t, std::size_t) { return step != Step::kWrite; }};
  EXPECT_EQ(flasher.write().failure, "write interrupted");
  EXPECT_FALSE(image_of_binary(std::span{board.chip}.first(256)).image.is_bootable());
}

TEST(Flasher, ProgressOfEveryStepEndsAtItsTotal) {
  MemoryBootLoader board;
  PicobootClient client{board};
  const FlashImage image = bootable_image(1);
  std::array<std::pair<std::size_t, std::size_t>, 3> last{};
  Flasher flasher{client, image, [&](Step step, std::size_t done, std::size_t total) {
                    last[static_cast<std::size_t>(step)] = {done, total};
                    return true;
                  }};
  ASSERT_TRUE(flasher.write());
  for (const auto& [done, total] : last) {
    EXPECT_GT(total, 0U);
    EXPECT_EQ(done, total);
  }
}

}  // namespace
}  // namespace slamd::flash
