// What waits for the host: order, drops, and that the counts add up.

#include "firmware/core/outbox.hpp"

#include <gtest/gtest.h>

#include "firmware/protocol/reply.hpp"

namespace slamd {
namespace {

ImuFrame frame(std::uint16_t sequence) {
  ImuFrame frame;
  frame.sequence = sequence;
  return frame;
}

ImuFrame read(const WirePacket& packet) {
  const auto decoded = decode_imu_packet(packet.span().first(packet.size - 1U));
  EXPECT_TRUE(decoded);
  return decoded.frame;
}

TEST(Outbox, FramesLeaveInOrder) {
  Outbox outbox;
  outbox.set_open(true);
  for (std::uint16_t i = 0; i < 5; ++i) outbox.push(frame(i));
  for (std::uint16_t i = 0; i < 5; ++i) EXPECT_EQ(read(outbox.next()).sequence, i);
  EXPECT_TRUE(outbox.empty());
  EXPECT_EQ(outbox.dropped(), 0U);
}

TEST(Outbox, TheFirstFrameEverSentSaysSo) {
  Outbox outbox;
  outbox.push(frame(0));  // nobody listens
  outbox.set_open(true);
  outbox.push(frame(1));
  outbox.push(frame(2));
  EXPECT_TRUE(read(outbox.next()).has(ImuStatus::kFirstFrame));
  EXPECT_FALSE(read(outbox.next()).has(ImuStatus::kFirstFrame));
}

TEST(Outbox, AFullQueueDropsTheOldestAndTheNextFrameTellsHowMany) {
  Outbox outbox;
  outbox.set_open(true);
  constexpr std::uint16_t kPushed = Outbox::kFrames + 50;
  for (std::uint16_t i = 0; i < kPushed; ++i) outbox.push(frame(i));
  const ImuFrame first = read(outbox.next());
  EXPECT_EQ(first.sequence, 50);
  EXPECT_EQ(first.dropped, 50);
  std::uint32_t sent = 1;
  while (!outbox.empty()) {
    outbox.next();
    ++sent;
  }
  EXPECT_EQ(sent + outbox.dropped(), kPushed);
  EXPECT_EQ(outbox.most_frames(), Outbox::kFrames);
}

TEST(Outbox, AClosedPortKeepsNothingForLater) {
  Outbox outbox;
  outbox.set_open(true);
  outbox.push(frame(0));
  outbox.push(frame(1));
  outbox.set_open(false);
  outbox.push(frame(2));
  EXPECT_TRUE(outbox.empty());
  EXPECT_EQ(outbox.dropped(), 3U);
  outbox.set_open(true);
  outbox.push(frame(3));
  EXPECT_EQ(read(outbox.next()).sequence, 3);
}

TEST(Outbox, RepliesGoBeforeFramesAndAlsoWhenThePortIsClosed) {
  Outbox outbox;
  outbox.set_open(true);
  outbox.push(frame(0));
  outbox.push_reply(encode(Acknowledgement{4, 9, CommandResult::kAccepted}));
  const WirePacket reply = outbox.next();
  const auto opened = open_packet(reply.span().first(reply.size - 1U));
  ASSERT_TRUE(opened);
  EXPECT_EQ(read_packet<Acknowledgement>(*opened)->tag, 9);
  outbox.set_open(false);
  outbox.push_reply(encode(Acknowledgement{4, 10, CommandResult::kAccepted}));
  EXPECT_FALSE(outbox.empty());
}

TEST(Outbox, DroppedWrapsInTheFrameAsItsSixteenBitsDo) {
  Outbox outbox;
  for (int i = 0; i < 65'537; ++i) outbox.push(frame(0));
  outbox.set_open(true);
  outbox.push(frame(1));
  EXPECT_EQ(read(outbox.next()).dropped, 1);
  EXPECT_EQ(outbox.dropped(), 65'537U);
}

}  // namespace
}  // namespace slamd
