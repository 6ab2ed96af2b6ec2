// The packets of both directions: round trips, layouts, and that damage is never read as something.

#include <gtest/gtest.h>

#include <random>

#include "firmware/protocol/command.hpp"
#include "firmware/protocol/imu_frame.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd {
namespace {

template <std::size_t N>
std::optional<OpenedPacket> reopen(const std::array<std::uint8_t, N>& wire) {
  EXPECT_EQ(wire.back(), kImuFrameDelimiter);
  return open_packet(std::span{wire}.first(N - 1));
}

Statistics some_statistics() {
  Statistics s;
  s.sensor_state = SensorState::kFault;
  s.fault = SensorFault::kNoData;
  s.reset_cause = ResetCause::kWatchdog;
  s.tag = 0xBEEF;
  s.device_us = 0x0102030405060708;
  s.samples = 0x11121314;
  s.dropped = 0x21222324;
  s.overruns = 0x31323334;
  s.faults = 0x41424344;
  s.restarts = 0x5152;
  s.bus_recoveries = 0x6162;
  s.usb_resets = 0x7172;
  s.usb_suspends = 0x8182;
  s.bad_commands = 0x9192;
  s.latency_max_us = 0xA1A2;
  s.loop_max_us = 0xB1B2;
  s.queue_max_bytes = 0xC1C2;
  return s;
}

TEST(Packet, EveryReplyComesBackAsItWentOut) {
  const Identity identity{0x6C, 7, {1, 2, 3, 4, 5, 6, 7, 0xFF}, {1, 2, 3}, 2, 208, 500, 4};
  EXPECT_EQ(read_packet<Identity>(*reopen(encode(identity))), identity);
  EXPECT_EQ(read_packet<Statistics>(*reopen(encode(some_statistics()))), some_statistics());
  const SelfTestReport report{SelfTestOutcome::kFailed, 0x21, 9, {-100, 0, 1700}, {-7000, 1, 32767}};
  EXPECT_EQ(read_packet<SelfTestReport>(*reopen(encode(report))), report);
  const Acknowledgement acknowledgement{5, 0x1234, CommandResult::kBusy};
  EXPECT_EQ(read_packet<Acknowledgement>(*reopen(encode(acknowledgement))), acknowledgement);
  const Command command{3, 0xFF00};
  EXPECT_EQ(read_packet<Command>(*reopen(encode(command))), command);
}

TEST(Packet, LayoutOfTheCommandIsFixed) {
  const auto wire = encode(Command{5, 0x0100});
  const std::array<std::uint8_t, 5> plain{0x81, 5, 0x00, 0x01, 0};
  const auto opened = reopen(wire);
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->size, 6U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(opened->plain[i], plain[i]) << i;
}

TEST(Packet, ASampleOpensAsAPacketToo) {
  ImuFrame frame;
  frame.sequence = 77;
  const auto opened = reopen(encode(frame));
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->kind(), kImuFrameKindVersion);
}

TEST(Packet, OneKindIsNeverReadAsAnother) {
  const auto identity = reopen(encode(Identity{}));
  EXPECT_FALSE(read_packet<Statistics>(*identity));
  EXPECT_FALSE(read_packet<SelfTestReport>(*identity));
  EXPECT_FALSE(read_packet<Acknowledgement>(*identity));
  EXPECT_FALSE(read_packet<Command>(*identity));
}

TEST(Packet, EveryPacketIsShorterThanAUsbPacket) {
  EXPECT_LT(encode(Identity{}).size(), 64U);
  EXPECT_LT(encode(Statistics{}).size(), 64U);
  EXPECT_LT(encode(SelfTestReport{}).size(), 64U);
}

TEST(Packet, EverySingleDamagedBitIsSeen) {
  const auto wire = encode(some_statistics());
  for (std::size_t bit = 0; bit < 8 * (wire.size() - 1); ++bit) {
    auto damaged = wire;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(open_packet(std::span{damaged}.first(wire.size() - 1))) << "bit " << bit;
  }
}

TEST(Packet, TruncatedEmptyAndTooLongPacketsAreRefused) {
  const auto wire = encode(some_statistics());
  for (std::size_t size = 0; size + 1 < wire.size(); ++size) EXPECT_FALSE(open_packet(std::span{wire}.first(size)));
  const std::array<std::uint8_t, 200> ones = [] {
    std::array<std::uint8_t, 200> a;
    a.fill(1);
    return a;
  }();
  EXPECT_FALSE(open_packet(ones));
}

TEST(Packet, RandomBytesPassTheCrcAsSeldomAsSixteenBitsPromise) {
  std::mt19937 random{1};
  int opened = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::array<std::uint8_t, 9> bytes;
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() % 255 + 1);
    bytes[0] = 9;  // one block, so that COBS is right
    opened += open_packet(bytes).has_value() ? 1 : 0;
  }
  EXPECT_LT(opened, 15);  // 3 expected
}

}  // namespace
}  // namespace slamd
