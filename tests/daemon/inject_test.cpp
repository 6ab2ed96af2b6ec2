#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "daemon/inject/value_fault.hpp"
#include "daemon/inject/wire_fault.hpp"

namespace slamd {
namespace {

HostTime at(double seconds) {
  return HostTime{from_seconds(100.0 + seconds)};
}

constexpr HostTime kForEver = HostTime::max();

TEST(FaultSwitch, HoldsAVerbUntilItsTimeAndNoLonger) {
  FaultSwitch verbs;
  EXPECT_EQ(verbs.verb(at(0)), FaultVerb::kNone);
  verbs.set(FaultVerb::kStuck, at(2));
  EXPECT_EQ(verbs.verb(at(1.9)), FaultVerb::kStuck);
  EXPECT_NEAR(verbs.seconds_left(at(0.5)), 1.5, 1e-6);
  EXPECT_EQ(verbs.verb(at(2)), FaultVerb::kNone);
  verbs.set(FaultVerb::kOff, at(9));
  verbs.set(FaultVerb::kNone, at(9));
  EXPECT_EQ(verbs.verb(at(1)), FaultVerb::kNone);
}

TEST(FaultSwitch, EveryVerbHasANameThatLeadsBackToIt) {
  for (const FaultVerb verb : kFaultVerbs) EXPECT_EQ(fault_verb(name(verb)), verb);
  EXPECT_FALSE(fault_verb("unknown"));
}

/// A wire of one read of ten bytes every 0.1 s.
class Wire {
 public:
  explicit Wire(FaultVerb verb, double until_s) { verbs_.set(verb, at(until_s)); }

  void pass(double until_s) {
    for (; now_s_ < until_s - 1e-9; now_s_ += 0.1) {
      wire_.pass(read_, at(now_s_), [this](std::span<const std::uint8_t> bytes, HostTime arrival) {
        EXPECT_EQ(arrival, at(now_s_));
        reads.emplace_back(bytes.begin(), bytes.end());
      });
    }
  }

  std::vector<std::vector<std::uint8_t>> reads;
  const std::vector<std::uint8_t> read_ = std::vector<std::uint8_t>(10, 0xAA);

 private:
  FaultSwitch verbs_;
  WireFault wire_{verbs_, {.delay = from_seconds(0.35), .period = from_seconds(2.0), .held_reads = 8, .read_bytes = 16}};
  double now_s_ = 0.0;
};

TEST(WireFault, LetsEverythingThroughWithoutAFaultAndNothingWhenOff) {
  Wire good{FaultVerb::kNone, 0}, off{FaultVerb::kOff, 1.0};
  good.pass(1.0);
  EXPECT_EQ(good.reads, std::vector(10, good.read_));
  off.pass(1.0);
  EXPECT_TRUE(off.reads.empty());
  off.pass(2.0);
  EXPECT_EQ(off.reads.size(), 10U);
}

TEST(WireFault, GarbageKeepsTheLengthAndDamagesSomeBytes) {
  Wire wire{FaultVerb::kGarbage, 100.0};
  wire.pass(20.0);
  ASSERT_EQ(wire.reads.size(), 200U);
  int damaged = 0;
  for (const auto& read : wire.reads) {
    ASSERT_EQ(read.size(), 10U);
    for (const std::uint8_t byte : read) damaged += byte != 0xAA;
  }
  EXPECT_NEAR(damaged, 2000 / 8, 60);
}

TEST(WireFault, DelayedBytesComeLateAndTheRestAtOnceWhenItEnds) {
  Wire wire{FaultVerb::kDelayed, 1.0};
  wire.pass(0.35);
  EXPECT_TRUE(wire.reads.empty());
  wire.pass(1.0);
  EXPECT_EQ(wire.reads.size(), 6U);
  wire.pass(1.1);
  EXPECT_EQ(wire.reads.size(), 11U) << "nothing is lost";
}

TEST(WireFault, WhatDoesNotFitIntoTheDelayIsLostOldestFirst) {
  FaultSwitch verbs;
  verbs.set(FaultVerb::kDelayed, kForEver);
  WireFault wire{verbs, {.delay = from_seconds(10), .period = from_seconds(1), .held_reads = 2, .read_bytes = 4}};
  const std::vector<std::uint8_t> read{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  wire.pass(read, at(0), [](auto, HostTime) { FAIL() << "it is too early"; });
  std::vector<std::uint8_t> got;
  wire.pass({}, at(11), [&](auto bytes, HostTime) { got.insert(got.end(), bytes.begin(), bytes.end()); });
  EXPECT_EQ(got, (std::vector<std::uint8_t>{5, 6, 7, 8, 9, 10}));
}

TEST(WireFault, AnIntermittentWireIsOffHalfOfTheTime) {
  Wire wire{FaultVerb::kIntermittent, 100.0};
  wire.pass(20.0);
  EXPECT_NEAR(static_cast<double>(wire.reads.size()), 100.0, 2.0);
}

TEST(ImuValueFault, StuckRepeatsTheFirstValuesAndWrongAddsToThem) {
  FaultSwitch verbs;
  ImuValueFault fault{verbs};
  ImuSample sample{.time = at(1), .arrival = at(1)};
  sample.gyro_rads = {1, 2, 3};
  EXPECT_EQ(fault.apply(sample)->gyro_rads, sample.gyro_rads);
  verbs.set(FaultVerb::kStuck, kForEver);
  EXPECT_EQ(fault.apply(sample)->gyro_rads, sample.gyro_rads);
  ImuSample next = sample;
  next.gyro_rads = {4, 5, 6};
  next.time = at(2);
  EXPECT_EQ(fault.apply(next)->gyro_rads, sample.gyro_rads);
  EXPECT_EQ(fault.apply(next)->time, next.time);
  verbs.set(FaultVerb::kWrong, kForEver);
  EXPECT_GT((fault.apply(next)->gyro_rads - next.gyro_rads).norm(), 0.1);
  EXPECT_GT((fault.apply(next)->accel_mps2 - next.accel_mps2).norm(), 1.0);
  verbs.set(FaultVerb::kSlow, kForEver);
  int through = 0;
  for (int i = 0; i < 100; ++i) through += fault.apply(next).has_value();
  EXPECT_EQ(through, 25);
}

TEST(GnssValueFault, StuckIsMarkedStaleWhileTheVehicleMoves) {
  FaultSwitch verbs;
  verbs.set(FaultVerb::kStuck, kForEver);
  for (const double speed_mps : {8.0, 0.0}) {
    GnssValueFault fault{verbs};
    GnssFix fix{.time = at(1), .arrival = at(1), .utc = {}};
    fix.speed_mps = speed_mps;
    fix.latitude_deg = 48.0;
    EXPECT_FALSE(fault.apply(fix)->stale);
    fix.time = fix.arrival = at(2);
    fix.latitude_deg = 48.1;
    const GnssFix repeated = *fault.apply(fix);
    EXPECT_EQ(repeated.latitude_deg, 48.0);
    EXPECT_EQ(repeated.time, at(2));
    EXPECT_EQ(repeated.stale, speed_mps > 0.0);
  }
}

TEST(GnssValueFault, WrongIsFiftyMetresEast) {
  FaultSwitch verbs;
  verbs.set(FaultVerb::kWrong, kForEver);
  GnssFix fix{.time = at(1), .arrival = at(1), .utc = {}};
  fix.latitude_deg = 60.0;
  const GnssFix wrong = *GnssValueFault{verbs}.apply(fix);
  EXPECT_EQ(wrong.latitude_deg, fix.latitude_deg);
  EXPECT_NEAR(wrong.longitude_deg * M_PI / 180.0 * 6.378e6 * std::cos(M_PI / 3.0), 50.0, 0.2);
}

/// Packets of ten degrees whose only point says which one it is.
LidarPacket lidar_packet(int number) {
  LidarPacket packet;
  packet.time = packet.arrival = at(0.001 * number);
  packet.azimuth_begin_cdeg = static_cast<std::uint16_t>((number * 1000 + 123) % 36000);
  packet.azimuth_end_cdeg = packet.azimuth_begin_cdeg;
  packet.point_count = 1;
  packet.points[0] = {static_cast<float>(number), 1.0F, 1.0F, 0, packet.azimuth_begin_cdeg, 0, 0, 0};
  return packet;
}

TEST(LidarValueFault, StuckShowsOneWholeRevolutionForEverWithStampsThatGoOn) {
  FaultSwitch verbs;
  LidarValueFault fault{verbs};
  verbs.set(FaultVerb::kStuck, kForEver);
  for (int i = 5; i < 200; ++i) {
    const LidarPacket packet = lidar_packet(i);
    const LidarPacket* given = fault.apply(packet);
    ASSERT_NE(given, nullptr);
    EXPECT_EQ(given->time, packet.time);
    EXPECT_EQ(given->azimuth_begin_cdeg, packet.azimuth_begin_cdeg);
    EXPECT_EQ(given->points[0].x, static_cast<float>(5 + (i - 5) % 36));
  }
  verbs.set(FaultVerb::kNone, kForEver);
  EXPECT_EQ(fault.apply(lidar_packet(300))->points[0].x, 300.0F);
}

TEST(LidarValueFault, WrongIsTooLongAndSlowIsOneOfFour) {
  FaultSwitch verbs;
  LidarValueFault fault{verbs};
  verbs.set(FaultVerb::kWrong, kForEver);
  EXPECT_FLOAT_EQ(fault.apply(lidar_packet(10))->points[0].x, 12.0F);
  verbs.set(FaultVerb::kSlow, kForEver);
  int through = 0;
  for (int i = 0; i < 40; ++i) through += fault.apply(lidar_packet(i)) != nullptr;
  EXPECT_EQ(through, 10);
}

}  // namespace
}  // namespace slamd
