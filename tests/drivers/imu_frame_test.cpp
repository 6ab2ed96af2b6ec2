#include "firmware/protocol/imu_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string_view>
#include <vector>

#include "tests/support/imu_frames.hpp"

namespace slamd {
namespace {

ImuFrame some_frame() {
  ImuFrame frame;
  frame.status = static_cast<std::uint8_t>(ImuStatus::kFirstFrame);
  frame.sequence = 0x1234;
  frame.device_us = 0x0102030405060708U;
  frame.gyro = {-1, 2, -32768};
  frame.accel = {0x00FF, 0x0100, 32767};
  frame.temperature = -256;
  frame.dropped = 7;
  return frame;
}

ImuFrame random_frame(std::mt19937& random) {
  std::uniform_int_distribution<int> byte{0, 255};
  std::array<std::uint8_t, 26> bytes{};
  const bool sparse = byte(random) < 64;  // many zeros: many COBS blocks
  for (auto& b : bytes) b = static_cast<std::uint8_t>(sparse && byte(random) < 200 ? 0 : byte(random));
  return test::frame_of(bytes);
}

std::span<const std::uint8_t> packet_of(const std::array<std::uint8_t, kImuFrameWireBytes>& wire) {
  return std::span{wire}.first(kImuFramePacketBytes);
}

TEST(Crc16, HasThePublishedCheckValue) {
  constexpr std::string_view kText = "123456789";
  std::array<std::uint8_t, 9> bytes{};
  std::copy(kText.begin(), kText.end(), bytes.begin());
  EXPECT_EQ(crc16(bytes), 0x29B1);
  EXPECT_EQ(crc16({}), 0xFFFF);
}

TEST(Cobs, EncodesThePapersExamples) {
  const auto encoded = [](std::vector<std::uint8_t> plain) {
    std::vector<std::uint8_t> out(cobs_max_encoded(plain.size()));
    out.resize(cobs_encode(plain, out));
    return out;
  };
  using Bytes = std::vector<std::uint8_t>;
  EXPECT_EQ(encoded({}), (Bytes{1}));
  EXPECT_EQ(encoded({0}), (Bytes{1, 1}));
  EXPECT_EQ(encoded({0x11, 0x22, 0, 0x33}), (Bytes{3, 0x11, 0x22, 2, 0x33}));
  EXPECT_EQ(encoded({0x11, 0, 0, 0}), (Bytes{2, 0x11, 1, 1, 1}));
  Bytes full(254);
  std::iota(full.begin(), full.end(), std::uint8_t{1});
  Bytes expected = full;
  expected.insert(expected.begin(), 0xFF);
  EXPECT_EQ(encoded(full), expected);
}

TEST(Cobs, DecodesWhatItEncodedAtEveryLength) {
  std::mt19937 random{1};
  for (std::size_t size = 1; size < 600; ++size) {
    std::vector<std::uint8_t> plain(size);
    for (auto& b : plain) b = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random());
    if (size % 5 == 0) std::fill(plain.begin(), plain.end(), std::uint8_t{9});
    std::vector<std::uint8_t> encoded(cobs_max_encoded(size));
    encoded.resize(cobs_encode(plain, encoded));
    EXPECT_EQ(std::count(encoded.begin(), encoded.end(), 0), 0);
    std::vector<std::uint8_t> decoded(size);
    ASSERT_EQ(cobs_decode(encoded, decoded), size);
    ASSERT_EQ(decoded, plain);
  }
}

TEST(Cobs, RefusesZerosOverrunsAndLackOfRoom) {
  std::array<std::uint8_t, 4> out{};
  EXPECT_EQ(cobs_decode(std::vector<std::uint8_t>{0, 1}, out), 0U);
  EXPECT_EQ(cobs_decode(std::vector<std::uint8_t>{3, 1, 0}, out), 0U);
  EXPECT_EQ(cobs_decode(std::vector<std::uint8_t>{5, 1, 2}, out), 0U);
  EXPECT_EQ(cobs_decode(std::vector<std::uint8_t>{6, 1, 2, 3, 4, 5}, out), 0U);
}

TEST(ImuFrame, LiesOnTheWireAsTheTableSays) {
  const std::array<std::uint8_t, kImuFramePlainBytes> plain = pack(some_frame());
  const std::array<std::uint8_t, 28> expected{0x11, 0x20, 0x34, 0x12, 8,    7,    6,    5,    4,    3,
                                              2,    1,    0xFF, 0xFF, 2,    0,    0x00, 0x80, 0xFF, 0x00,
                                              0x00, 1,    0xFF, 0x7F, 0x00, 0xFF, 7,    0};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), plain.begin()));
  EXPECT_EQ(plain[28] | (plain[29] << 8), crc16(std::span{plain}.first(28)));
}

TEST(ImuFrame, IsFoundAgainWhateverItHolds) {
  std::mt19937 random{2};
  for (int i = 0; i < 20'000; ++i) {
    const ImuFrame frame = random_frame(random);
    const auto wire = encode(frame);
    EXPECT_EQ(wire.back(), kImuFrameDelimiter);
    ASSERT_EQ(std::count(wire.begin(), wire.end() - 1, 0), 0);
    const DecodedImuFrame decoded = decode_imu_packet(packet_of(wire));
    ASSERT_TRUE(decoded);
    ASSERT_EQ(decoded.frame, frame);
  }
}

TEST(ImuFrame, NoChangedBitPassesTheCheck) {
  const auto wire = encode(some_frame());
  for (std::size_t bit = 0; bit < kImuFramePacketBytes * 8; ++bit) {
    auto changed = wire;
    changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(decode_imu_packet(packet_of(changed))) << bit;
  }
}

TEST(ImuFrame, SaysWhyAPacketIsRefused) {
  const auto wire = encode(some_frame());
  EXPECT_EQ(decode_imu_packet(std::span{wire}.first(30)).error, ImuFrameError::kLength);
  EXPECT_EQ(decode_imu_packet(wire).error, ImuFrameError::kLength);
  auto bad_code = wire;
  bad_code[0] = 0xFE;
  EXPECT_EQ(decode_imu_packet(packet_of(bad_code)).error, ImuFrameError::kCobs);
  auto bad_value = wire;
  bad_value[2] ^= 1U;
  EXPECT_EQ(decode_imu_packet(packet_of(bad_value)).error, ImuFrameError::kCrc);

  auto plain = pack(some_frame());
  plain[0] = 0x12;
  wire::store(plain, 28, crc16(std::span<const std::uint8_t>{plain}.first(28)));
  std::array<std::uint8_t, kImuFramePacketBytes> other_version{};
  cobs_encode(plain, other_version);
  EXPECT_EQ(decode_imu_packet(other_version).error, ImuFrameError::kVersion);
}

}  // namespace
}  // namespace slamd
