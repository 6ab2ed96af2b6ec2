// The fault grammar of slam-sim and what the faults do to the stream of bytes.

#include <gtest/gtest.h>

#include "firmware/protocol/imu_frame.hpp"
#include "tools/slam-sim/sensors/fault_injector.hpp"
#include "tools/slam-sim/sensors/sensor_clock.hpp"
#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {
namespace {

Fault parsed(const std::string& text) {
  const auto result = parse_fault(text);
  EXPECT_TRUE(std::holds_alternative<Fault>(result)) << text;
  return std::holds_alternative<Fault>(result) ? std::get<Fault>(result) : Fault{};
}

TEST(SimFault, TheGrammarGivesSensorKindValueStartAndDuration) {
  const Fault loss = parsed("lidar:loss=0.02");
  EXPECT_EQ(loss.sensor, Channel::kLidar);
  EXPECT_EQ(loss.kind, FaultKind::kLoss);
  EXPECT_EQ(loss.value, 0.02);
  EXPECT_TRUE(loss.active(0.0));
  EXPECT_TRUE(loss.active(1e6));
  const Fault gap = parsed("imu:gap@60+2.5");
  EXPECT_FALSE(gap.active(59.9));
  EXPECT_TRUE(gap.active(62.4));
  EXPECT_FALSE(gap.active(62.5));
  const Fault jump = parsed("gps:jump=30@50+20");
  EXPECT_EQ(jump.kind, FaultKind::kJump);
  EXPECT_EQ(jump.value, 30.0);
  EXPECT_EQ(parsed("lidar:clock-jump=-250@60").value, -250.0);
  EXPECT_EQ(parsed("imu:corrupt=1e-3").value, 1e-3);
}

struct BadFault {
  const char* text;
  const char* token;
};
class SimBadFault : public testing::TestWithParam<BadFault> {};

TEST_P(SimBadFault, IsRefusedNamingTheBadToken) {
  const auto result = parse_fault(GetParam().text);
  ASSERT_TRUE(std::holds_alternative<std::string>(result));
  EXPECT_NE(std::get<std::string>(result).find("\"" + std::string(GetParam().token) + "\" "), std::string::npos)
      << std::get<std::string>(result);
}

INSTANTIATE_TEST_SUITE_P(All, SimBadFault,
                         testing::Values(BadFault{"radar:loss=1", "radar"}, BadFault{"", ""}, BadFault{"lidar", ""},
                                         BadFault{"lidar:melt", "melt"}, BadFault{"lidar:loss", "loss"},
                                         BadFault{"lidar:gap=3", "gap"}, BadFault{"lidar:loss=much", "much"},
                                         BadFault{"lidar:loss=1.5", "1.5"}, BadFault{"imu:jump=3", "jump"},
                                         BadFault{"gps:clock-jump=3", "clock-jump"}, BadFault{"imu:gap@x", "x"},
                                         BadFault{"imu:gap@1+", ""}, BadFault{"imu:gap@1+-2", "-2"},
                                         BadFault{"imu:late=-1", "-1"}, BadFault{"imu:gap@-1", "-1"}));

WireEvent frame_at(double t, std::int16_t value) {
  ImuFrame frame;
  frame.sequence = static_cast<std::uint16_t>(std::lround(t * 200));
  frame.gyro = {value, value, value};
  const auto bytes = encode(frame);
  const auto ns = static_cast<std::int64_t>(t * 1e9);
  return {Channel::kImu, ns, ns + 1000, {bytes.begin(), bytes.end()}};
}

ImuFrame decoded(const WireEvent& event) {
  return decode_imu_packet(std::span<const std::uint8_t>{event.bytes}.first(kImuFramePacketBytes)).frame;
}

TEST(SimFault, AGapSilencesItsSensorForItsTimeOnly) {
  FaultInjector injector{{parsed("imu:gap@1+2")}, 1};
  EXPECT_TRUE(injector.apply(frame_at(0.99, 1)));
  EXPECT_FALSE(injector.apply(frame_at(1.0, 1)));
  EXPECT_FALSE(injector.apply(frame_at(2.9, 1)));
  EXPECT_TRUE(injector.apply(frame_at(3.0, 1)));
  WireEvent gps = frame_at(2.0, 1);
  gps.channel = Channel::kGps;
  EXPECT_TRUE(injector.apply(gps));
}

TEST(SimFault, AStuckImuCountsOnWithFrozenValues) {
  FaultInjector injector{{parsed("imu:stuck@1+1")}, 1};
  ASSERT_TRUE(injector.apply(frame_at(0.995, 42)));
  for (const double t : {1.0, 1.5}) {
    const auto event = injector.apply(frame_at(t, 7));
    ASSERT_TRUE(event);
    EXPECT_EQ(decoded(*event).gyro[0], 42);
    EXPECT_EQ(decoded(*event).sequence, std::lround(t * 200));
  }
  EXPECT_EQ(decoded(*injector.apply(frame_at(2.0, 7))).gyro[0], 7);
}

TEST(SimFault, LossAndCorruptionHaveTheirFrequency) {
  FaultInjector loss{{parsed("imu:loss=0.1")}, 1};
  FaultInjector corrupt{{parsed("imu:corrupt=0.01")}, 1};
  int lost = 0, damaged = 0;
  for (int i = 0; i < 10'000; ++i) {
    const WireEvent event = frame_at(i * 0.005, 3);
    lost += loss.apply(event) ? 0 : 1;
    const auto after = corrupt.apply(event);
    for (std::size_t k = 0; k < event.bytes.size(); ++k) damaged += after->bytes[k] != event.bytes[k] ? 1 : 0;
  }
  EXPECT_NEAR(lost, 1000, 120);
  EXPECT_NEAR(damaged, 3200, 250);
}

TEST(SimFault, ALateSensorKeepsItsOrderOnTheCable) {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.max_duration_s = 2.0;
  spec.with_lidar = spec.with_gps = false;
  spec.faults = {parsed("imu:late=0.4@0.5+0.5")};
  Simulation simulation{spec};
  int last = -1, frames = 0;
  bool waited = false;
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      const int sequence = decoded(event).sequence;
      EXPECT_EQ(sequence, last + 1);
      last = sequence;
      ++frames;
      waited = waited || event.arrival_ns - event.taken_ns > 390'000'000;
    }
  }
  EXPECT_NEAR(frames, 400, 1);  // 200 Hz by a clock of its own
  EXPECT_TRUE(waited);
}

TEST(SimFault, AClockIsSetAndDrifts) {
  SensorClock clock{100.0, 10.0};
  clock.step_at(5.0, 0.25);
  clock.drift_between(10.0, 20.0, 100.0);
  EXPECT_NEAR(clock.reading(4.999), 104.999 + 4.999e-5, 1e-9);
  EXPECT_NEAR(clock.reading(5.0), 105.25 + 5e-5, 1e-9);
  EXPECT_NEAR(clock.reading(30.0), 130.25 + 30e-5 + 1e-3, 1e-9);
}

TEST(SimFault, AGpsJumpMovesTheFixButNotItsClaim) {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kStandstill;
  spec.max_duration_s = 4.0;
  spec.with_lidar = spec.with_imu = false;
  spec.gps.sentences = "GGA";
  spec.gps.correlated_m = spec.gps.white_m = 0.0;
  spec.faults = {parsed("gps:jump=30@2+10")};
  Simulation simulation{spec};
  std::vector<double> minutes;
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      const std::string text(event.bytes.begin(), event.bytes.end());
      minutes.push_back(std::stod(text.substr(19, 8)) + std::stod(text.substr(33, 8)));
      EXPECT_LT(std::stod(text.substr(text.find(",E,1,11,") + 8, 4)), 1.3) << text;
    }
  }
  ASSERT_GE(minutes.size(), 4U);
  EXPECT_NEAR(minutes[0], minutes[1], 1e-4);
  EXPECT_GT(std::abs(minutes[2] - minutes[1]), 1e-3);
}

}  // namespace
}  // namespace slamd::sim
