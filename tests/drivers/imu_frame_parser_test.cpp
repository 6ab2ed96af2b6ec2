#include "drivers/imu/imu_frame_parser.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "drivers/imu/imu_scale.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// A device with a clock, a sequence and a line to the parser.
class ImuFrameParserTest : public testing::Test {
 protected:
  ImuFrame next() {
    ImuFrame frame;
    frame.sequence = sequence_++;
    frame.device_us = device_us_;
    frame.accel = {0, 0, 8197};  // 1 g
    frame.gyro = {static_cast<std::int16_t>(frame.sequence), 0, 0};
    device_us_ += 5000;
    now_ += 5ms;
    return frame;
  }
  void receive(const Bytes& bytes) {
    parser_.feed(bytes, now_, [&](const ImuSample& sample) { samples_.push_back(sample); });
  }
  void receive(const ImuFrame& frame) {
    const auto wire = encode(frame);
    receive(Bytes{wire.begin(), wire.end()});
  }
  void receive_next(int count) {
    for (int i = 0; i < count; ++i) receive(next());
  }

  ImuFrameParser parser_;
  std::vector<ImuSample> samples_;
  HostTime now_{1000s};
  std::uint64_t device_us_ = 1'000'000;
  std::uint16_t sequence_ = 0;
};

TEST_F(ImuFrameParserTest, GivesSiUnitsByTheDataSheetsScales) {
  ImuFrame frame = next();
  frame.gyro = {1000, -1000, 0};
  frame.accel = {0, -8197, 1};
  frame.temperature = -256;
  receive(frame);
  ASSERT_EQ(samples_.size(), 1U);
  const ImuSample& sample = samples_[0];
  EXPECT_NEAR(sample.gyro_rads.x(), 17.5 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(sample.gyro_rads.y(), -17.5 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(sample.accel_mps2.y(), -8197 * 0.122e-3 * 9.80665, 1e-12);
  EXPECT_NEAR(sample.accel_mps2.z(), 0.122e-3 * 9.80665, 1e-12);
  EXPECT_FLOAT_EQ(sample.temperature_c, 24.0F);
  EXPECT_EQ(sample.arrival, now_);
  EXPECT_FALSE(sample.clipped);
}

TEST_F(ImuFrameParserTest, AnySplitOfTheStreamGivesTheSameSamples) {
  Bytes all;
  for (int i = 0; i < 50; ++i) {
    const auto wire = encode(next());
    all.insert(all.end(), wire.begin(), wire.end());
  }
  receive(all);
  ASSERT_EQ(samples_.size(), 50U);
  ImuFrameParser bytewise;
  std::vector<ImuSample> others;
  for (const std::uint8_t byte : all) {
    bytewise.feed({&byte, 1}, now_, [&](const ImuSample& sample) { others.push_back(sample); });
  }
  ASSERT_EQ(others.size(), samples_.size());
  for (std::size_t i = 0; i < others.size(); ++i) {
    EXPECT_EQ(others[i].time, samples_[i].time);
    EXPECT_EQ(others[i].gyro_rads, samples_[i].gyro_rads);
  }
}

TEST_F(ImuFrameParserTest, FindsTheFrameAfterAnyGarbageAndOneDelimiter) {
  std::mt19937 random{5};
  for (int round = 0; round < 2000; ++round) {
    Bytes garbage(random() % 100);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(random());
    garbage.push_back(0);
    const std::size_t before = samples_.size();
    receive(garbage);
    ASSERT_EQ(samples_.size(), before);
    receive(next());
    ASSERT_EQ(samples_.size(), before + 1);
  }
  EXPECT_EQ(parser_.stats().gaps, 0U);
  EXPECT_GT(parser_.stats().garbage_bytes, 10'000U);
}

TEST_F(ImuFrameParserTest, ACutFrameCostsOnlyItselfAndTheOneItRunsInto) {
  receive_next(3);
  const auto cut = encode(next());
  receive(Bytes{cut.begin(), cut.begin() + 20});
  receive_next(1);
  EXPECT_EQ(samples_.size(), 3U);
  receive_next(1);
  EXPECT_EQ(samples_.size(), 4U);
  EXPECT_EQ(parser_.stats().gaps, 1U);
  EXPECT_EQ(parser_.stats().missing, 2U);
}

TEST_F(ImuFrameParserTest, CountsGapsBySequenceAlsoOverTheWrap) {
  sequence_ = 65533;
  receive_next(2);
  next();
  next();
  next();
  receive_next(2);
  EXPECT_EQ(parser_.stats().gaps, 1U);
  EXPECT_EQ(parser_.stats().missing, 3U);
  EXPECT_EQ(samples_.size(), 4U);
}

TEST_F(ImuFrameParserTest, AResetOfTheDeviceIsConfirmedByItsSecondFrame) {
  receive_next(400);
  device_us_ = 1000;
  sequence_ = 0;
  receive_next(1);
  EXPECT_EQ(samples_.size(), 400U);
  receive_next(400);
  EXPECT_EQ(samples_.size(), 800U);
  EXPECT_EQ(parser_.stats().resets, 1U);
  EXPECT_EQ(parser_.stats().gaps, 0U);
  EXPECT_EQ(parser_.clock().jumps(), 1U);
  EXPECT_TRUE(parser_.clock().locked());
  EXPECT_NEAR(to_seconds(samples_.back().time - samples_[300].time), 0.005 * 500, 1e-3);
}

TEST_F(ImuFrameParserTest, OneFrameWithAnImpossibleStampIsDroppedAlone) {
  receive_next(100);
  ImuFrame lie = next();
  lie.device_us = 0xFFFF'FFFF'FFFF'FFFFU;
  receive(lie);
  lie.device_us = 12'345'678'901'234U;
  receive(lie);
  receive_next(100);
  EXPECT_EQ(samples_.size(), 200U);
  EXPECT_EQ(parser_.stats().implausible, 2U);
  EXPECT_EQ(parser_.stats().resets, 0U);
}

TEST_F(ImuFrameParserTest, ARepeatedFrameIsCountedAndDropped) {
  const ImuFrame frame = next();
  receive(frame);
  receive(frame);
  EXPECT_EQ(samples_.size(), 1U);
  EXPECT_EQ(parser_.stats().repeated, 1U);
}

TEST_F(ImuFrameParserTest, FlagsClippingByStatusAndByValue) {
  ImuFrame frame = next();
  frame.status = static_cast<std::uint8_t>(ImuStatus::kAccelClipped);
  receive(frame);
  for (const std::int16_t end : {std::int16_t{-32768}, std::int16_t{32767}}) {
    frame = next();
    frame.gyro[1] = end;
    receive(frame);
  }
  frame = next();
  frame.accel[0] = 32700;
  receive(frame);
  ASSERT_EQ(samples_.size(), 4U);
  EXPECT_TRUE(samples_[0].clipped);
  EXPECT_TRUE(samples_[1].clipped);
  EXPECT_TRUE(samples_[2].clipped);
  EXPECT_FALSE(samples_[3].clipped);
}

TEST_F(ImuFrameParserTest, AFaultySensorGivesNoSamples) {
  receive_next(1);
  ImuFrame frame = next();
  frame.status = static_cast<std::uint8_t>(ImuStatus::kSensorFault);
  frame.dropped = 9;
  receive(frame);
  EXPECT_EQ(samples_.size(), 1U);
  EXPECT_EQ(parser_.stats().sensor_faults, 1U);
  EXPECT_EQ(parser_.stats().dropped_at_device, 9U);
}

}  // namespace
}  // namespace slamd
