// The board as a whole on the register model: frames, status bits, commands, starts anew, watchdog.

#include "firmware/core/device.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "firmware/core/version.hpp"
#include "tests/firmware/sensor_fake.hpp"

namespace slamd {
namespace {

struct Received {
  std::vector<ImuFrame> frames;
  std::vector<OpenedPacket> replies;
};

class DeviceTest : public testing::Test {
 protected:
  BoardFacts facts_{{0xDE, 0xAD, 0, 1, 2, 3, 4, 5}, 2, ResetCause::kPower};
  test::SensorFake fake_;
  Device device_{fake_, facts_};
  Micros now_ = 0;
  bool read_ = true;  // the host fetches packets

  Received run(Micros duration) {
    Received received;
    for (const Micros end = now_ + duration; now_ < end; now_ += 100) {
      device_.step(now_, fake_.at(now_));
      while (read_ && device_.has_packet()) take(device_.next_packet(), received);
    }
    return received;
  }

  static void take(const WirePacket& packet, Received& received) {
    const auto opened = open_packet(packet.span().first(packet.size - 1U));
    ASSERT_TRUE(opened);
    if (opened->kind() != kImuFrameKindVersion) return received.replies.push_back(*opened);
    received.frames.push_back(decode_imu_packet(packet.span().first(packet.size - 1U)).frame);
  }

  void command(CommandCode code, std::uint16_t tag) { command(static_cast<std::uint8_t>(code), tag); }
  void command(std::uint8_t code, std::uint16_t tag) {
    const auto bytes = encode(Command{code, tag});
    device_.set_counters({3, 2, 77});
    device_.receive(bytes, now_);
  }
};

TEST_F(DeviceTest, StreamsNumberedFramesAtTheSensorsRate) {
  device_.set_open(true);
  fake_.gyro = {1, 2, 3};
  fake_.accel = {4, 5, 6};
  fake_.temperature = 512;
  const Received received = run(1'000'000);
  ASSERT_NEAR(static_cast<double>(received.frames.size()), 200, 4);
  EXPECT_TRUE(received.frames[0].has(ImuStatus::kFirstFrame));
  for (std::size_t i = 0; i < received.frames.size(); ++i) {
    const ImuFrame& frame = received.frames[i];
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.gyro, fake_.gyro);
    EXPECT_EQ(frame.accel, fake_.accel);
    EXPECT_EQ(frame.temperature, 512);
    EXPECT_EQ(frame.dropped, 0);
    if (i > 0) {
      EXPECT_EQ(frame.status, 0);
      EXPECT_EQ(frame.device_us - received.frames[i - 1].device_us, test::SensorFake::kPeriod);
    }
  }
}

TEST_F(DeviceTest, ClippedAxesAreTold) {
  device_.set_open(true);
  fake_.gyro = {0, INT16_MIN, 0};
  for (const ImuFrame& frame : run(200'000).frames) {
    EXPECT_TRUE(frame.has(ImuStatus::kGyroClipped));
    EXPECT_FALSE(frame.has(ImuStatus::kAccelClipped));
  }
  fake_.gyro = {};
  fake_.accel = {INT16_MAX, 0, 0};
  run(5'000);
  const auto frames = run(100'000).frames;
  ASSERT_FALSE(frames.empty());
  for (const ImuFrame& frame : frames) {
    EXPECT_FALSE(frame.has(ImuStatus::kGyroClipped));
    EXPECT_TRUE(frame.has(ImuStatus::kAccelClipped));
  }
}

TEST_F(DeviceTest, AWatchdogStartIsInEveryFrame) {
  facts_.reset_cause = ResetCause::kWatchdog;
  Device device{fake_, facts_};
  device.set_open(true);
  int frames = 0;
  for (; now_ < 200'000; now_ += 100) {
    device.step(now_, fake_.at(now_));
    Received received;
    while (device.has_packet()) take(device.next_packet(), received);
    for (const ImuFrame& frame : received.frames) EXPECT_TRUE(frame.has(ImuStatus::kWatchdogReset));
    frames += static_cast<int>(received.frames.size());
  }
  EXPECT_GT(frames, 20);
}

TEST_F(DeviceTest, ALostSensorIsToldTenTimesASecondAndOnceWithEachCause) {
  device_.set_open(true);
  run(200'000);
  fake_.present = false;
  const Received received = run(1'000'000);
  int faults = 0;
  for (const ImuFrame& frame : received.frames) faults += frame.has(ImuStatus::kSensorFault) ? 1 : 0;
  EXPECT_NEAR(faults, 10, 1);
  ASSERT_EQ(received.replies.size(), 2U) << "no data at first, then no answer";
  EXPECT_EQ(read_packet<Statistics>(received.replies[0])->fault, SensorFault::kNoData);
  const auto statistics = read_packet<Statistics>(received.replies[1]);
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->sensor_state, SensorState::kFault);
  EXPECT_EQ(statistics->fault, SensorFault::kNoAnswer);
  EXPECT_EQ(statistics->tag, 0);
  EXPECT_EQ(device_.led(false), LedState::kFault);

  fake_.present = true;
  const Received back = run(500'000);
  ASSERT_FALSE(back.replies.empty());
  EXPECT_EQ(read_packet<Statistics>(back.replies.back())->sensor_state, SensorState::kRunning);
  EXPECT_FALSE(back.frames.back().has(ImuStatus::kSensorFault));
}

TEST_F(DeviceTest, SequenceGoesOnThroughFaultsAndDrops) {
  device_.set_open(true);
  run(200'000);
  read_ = false;
  run(3'000'000);
  read_ = true;
  const auto frames = run(10'000).frames;
  ASSERT_GT(frames.size(), Outbox::kFrames - 2);
  const auto gap = static_cast<std::uint16_t>(frames[0].sequence - 36);
  EXPECT_EQ(frames[0].dropped, gap) << "the first frame behind the gap tells its size";
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_EQ(frames[i].sequence - frames[i - 1].sequence, 1);
}

TEST_F(DeviceTest, EveryCommandGetsOneReplyWithItsTag) {
  device_.set_open(true);
  run(200'000);
  command(CommandCode::kIdentity, 1);
  command(CommandCode::kStatistics, 2);
  command(99, 3);
  const auto replies = run(100).replies;
  ASSERT_EQ(replies.size(), 3U);
  const auto identity = read_packet<Identity>(replies[0]);
  ASSERT_TRUE(identity);
  EXPECT_EQ(*identity, (Identity{0x6C, 1, facts_.id, kFirmwareVersion, 2, 208, 500, 4}));
  const auto statistics = read_packet<Statistics>(replies[1]);
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->tag, 2);
  EXPECT_EQ(statistics->device_us, now_ - 100);
  EXPECT_NEAR(statistics->samples, 36, 2);
  EXPECT_EQ(statistics->usb_resets, 3);
  EXPECT_EQ(statistics->usb_suspends, 2);
  EXPECT_EQ(statistics->loop_max_us, 77);
  EXPECT_LE(statistics->latency_max_us, 400);
  const auto refusal = read_packet<Acknowledgement>(replies[2]);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(*refusal, (Acknowledgement{99, 3, CommandResult::kUnknown}));
}

TEST_F(DeviceTest, SelfTestRepliesOnceAndASecondOneMeanwhileIsBusy) {
  device_.set_open(true);
  run(200'000);
  fake_.self_test_gyro = {3000, 3000, 3000};
  command(CommandCode::kSelfTest, 5);
  command(CommandCode::kSelfTest, 6);
  std::vector<OpenedPacket> replies;
  for (const auto& packet : run(1'000'000).replies) {
    if (!read_packet<Statistics>(packet)) replies.push_back(packet);
  }
  ASSERT_EQ(replies.size(), 2U);
  EXPECT_EQ(*read_packet<Acknowledgement>(replies[0]), (Acknowledgement{3, 6, CommandResult::kBusy}));
  const auto report = read_packet<SelfTestReport>(replies[1]);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->tag, 5);
  EXPECT_EQ(report->outcome, SelfTestOutcome::kPassed);
}

TEST_F(DeviceTest, SelfTestWithoutSensorIsAnsweredAtOnce) {
  fake_.present = false;
  run(200'000);
  command(CommandCode::kSelfTest, 8);
  const auto replies = run(100).replies;
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(*read_packet<SelfTestReport>(replies[0]), (SelfTestReport{SelfTestOutcome::kNotRun, 0, 8, {}, {}}));
}

TEST_F(DeviceTest, AStartAnewIsAcknowledgedFirstAndHappensAfterwards) {
  command(CommandCode::kBootLoader, 4);
  EXPECT_EQ(device_.due_start(now_), StartRequest::kNone);
  const auto replies = run(90'000).replies;
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(*read_packet<Acknowledgement>(replies[0]), (Acknowledgement{5, 4, CommandResult::kAccepted}));
  EXPECT_EQ(device_.due_start(now_), StartRequest::kNone);
  EXPECT_EQ(device_.due_start(now_ + 20'000), StartRequest::kBootLoader);
}

TEST_F(DeviceTest, ResetCommandStartsTheProgramNotTheBootLoader) {
  command(CommandCode::kReset, 4);
  EXPECT_EQ(device_.due_start(200'000), StartRequest::kReset);
}

TEST_F(DeviceTest, TheWatchdogIsFedWhileTheWorkGoesOnAndNotWhenItStops) {
  for (int i = 0; i < 30; ++i) {
    fake_.present = i % 3 != 0;  // faults are work too
    run(100'000);
    EXPECT_TRUE(device_.alive(now_));
  }
  EXPECT_FALSE(device_.alive(now_ + 1'000'000));
}

TEST_F(DeviceTest, LedTellsTheState) {
  run(200'000);
  EXPECT_EQ(device_.led(false), LedState::kWaiting);
  device_.set_open(true);
  EXPECT_EQ(device_.led(false), LedState::kStreaming);
  EXPECT_EQ(device_.led(true), LedState::kDark);
}

TEST(Led, EachStateHasItsOwnPattern) {
  const auto on_for = [](LedState state) {
    int on = 0;
    int changes = 0;
    for (Micros t = 0; t < 1'048'576; t += 1'024) {
      on += led_on(state, t) ? 1 : 0;
      changes += led_on(state, t) != led_on(state, t + 1'024) ? 1 : 0;
    }
    return std::pair{on, changes};
  };
  EXPECT_EQ(on_for(LedState::kDark), (std::pair{0, 0}));
  EXPECT_EQ(on_for(LedState::kStreaming), (std::pair{1024, 0}));
  EXPECT_EQ(on_for(LedState::kFault), (std::pair{512, 8}));
  EXPECT_EQ(on_for(LedState::kWaiting).second, 2);
  EXPECT_NEAR(on_for(LedState::kWaiting).first, 49, 1);
}

}  // namespace
}  // namespace slamd
