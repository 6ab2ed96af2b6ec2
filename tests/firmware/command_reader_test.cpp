// The board's side of the command stream: split, merged and damaged.

#include "firmware/core/command_reader.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace slamd {
namespace {

std::vector<Command> feed(CommandReader& reader, const std::vector<std::uint8_t>& bytes) {
  std::vector<Command> commands;
  for (const std::uint8_t byte : bytes) {
    if (const auto command = reader.take(byte)) commands.push_back(*command);
  }
  return commands;
}

std::vector<std::uint8_t> wire(const Command& command) {
  const auto bytes = encode(command);
  return {bytes.begin(), bytes.end()};
}

TEST(CommandReader, FindsCommandsOneBehindTheOther) {
  CommandReader reader;
  std::vector<std::uint8_t> bytes = wire({1, 10});
  const auto second = wire({2, 20});
  bytes.insert(bytes.end(), second.begin(), second.end());
  EXPECT_EQ(feed(reader, bytes), (std::vector<Command>{{1, 10}, {2, 20}}));
  EXPECT_EQ(reader.rejected(), 0U);
}

TEST(CommandReader, EmptyPacketsAreNoCommandsAndNoErrors) {
  CommandReader reader;
  EXPECT_TRUE(feed(reader, {0, 0, 0}).empty());
  EXPECT_EQ(reader.rejected(), 0U);
}

TEST(CommandReader, AfterGarbageOfAnyLengthTheNextCommandIsFound) {
  std::mt19937 random{2};
  for (std::size_t length = 1; length < 300; ++length) {
    CommandReader reader;
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < length; ++i) bytes.push_back(static_cast<std::uint8_t>(random() % 255 + 1));
    bytes.push_back(0);
    const auto good = wire({4, 44});
    bytes.insert(bytes.end(), good.begin(), good.end());
    EXPECT_EQ(feed(reader, bytes), (std::vector<Command>{{4, 44}})) << length;
    EXPECT_EQ(reader.rejected(), 1U) << length;
  }
}

TEST(CommandReader, APacketOfAnotherKindIsRejected) {
  CommandReader reader;
  std::array<std::uint8_t, 6> plain{0x51, 1, 0, 0, 0, 0};
  const auto sealed = seal_packet(plain);
  EXPECT_TRUE(feed(reader, {sealed.begin(), sealed.end()}).empty());
  EXPECT_EQ(reader.rejected(), 1U);
}

}  // namespace
}  // namespace slamd
