#include "drivers/velodyne/vlp16_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/drivers/vlp16_bytes.hpp"

namespace slamd {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kStep600 = 40;  // hundredths of a degree a block at about 600 rpm
constexpr std::uint32_t kPeriodUs = 1327;
constexpr std::int64_t kStartNs = 5'000'000'000;

/// A sensor at constant speed: each call of next() is one packet later.
class Turning {
 public:
  explicit Turning(int step = kStep600, std::uint8_t mode = 0x37, std::uint32_t stamp_us = 1000, int azimuth = 0)
      : step_{step}, mode_{mode}, stamp_ns_{std::int64_t{stamp_us} * 1000}, azimuth_{azimuth} {}

  Vlp16Bytes next() {
    Vlp16Bytes packet{azimuth_, step_, static_cast<std::uint32_t>(stamp_ns_ / 1000 % 3'600'000'000), mode_};
    packet.fill_returns(5000);
    arrival_ = from_ns<HostTime>(kStartNs + stamp_ns_ + span_ns() + 40'000);
    skip();
    return packet;
  }
  void skip(int packets = 1) {
    stamp_ns_ += packets * span_ns();
    azimuth_ = (azimuth_ + packets * blocks() * step_) % 36000;
  }
  HostTime arrival() const { return arrival_; }  // of the newest packet

 private:
  int blocks() const { return mode_ == 0x39 ? 6 : 12; }
  std::int64_t span_ns() const { return blocks() * std::int64_t{110'592}; }
  int step_;
  std::uint8_t mode_;
  std::int64_t stamp_ns_;
  int azimuth_;
  HostTime arrival_;
};

const LidarPacket* feed(Vlp16Decoder& decoder, Turning& sensor) {
  const Vlp16Bytes packet = sensor.next();
  return decoder.decode(packet.span(), sensor.arrival());
}

TEST(Vlp16Decoder, GivesEveryFiringItsTimeRingAndInterpolatedAzimuth) {
  Vlp16Decoder decoder{{}};
  Turning sensor;
  const LidarPacket* packet = feed(decoder, sensor);
  ASSERT_NE(packet, nullptr);
  ASSERT_EQ(packet->point_count, 384);
  constexpr int kRings[16] = {0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15};
  for (int i = 0; i < 384; ++i) {
    const LidarPoint& p = packet->points[static_cast<std::size_t>(i)];
    const int time_ns = i / 16 * 55'296 + i % 16 * 2'304;
    EXPECT_EQ(p.time_offset_ns, time_ns);
    EXPECT_EQ(p.ring, kRings[i % 16]);
    EXPECT_NEAR(p.azimuth_cdeg, kStep600 * time_ns / 110'592.0, 0.51);
    EXPECT_EQ(p.return_index, 0);
  }
  EXPECT_EQ(packet->span, Duration{1'327'104});
  EXPECT_EQ(packet->azimuth_begin_cdeg, 0);
  EXPECT_EQ(packet->azimuth_end_cdeg, packet->points[383].azimuth_cdeg);
}

TEST(Vlp16Decoder, PlacesPointsByTheManualsGeometryInOurAxes) {
  constexpr double kElevationDeg[16] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
  constexpr double kHeightM[16] = {0.0112, -0.0007, 0.0097, -0.0022, 0.0081, -0.0037, 0.0066, -0.0051,
                                   0.0051, -0.0066, 0.0037, -0.0081, 0.0022, -0.0097, 0.0007, -0.0112};
  for (const int start : {0, 8950, 17980, 26970, 35900}) {
    for (const int step : {20, 40, 80}) {
      Vlp16Decoder decoder{{}};
      Turning sensor{step, 0x37, 0, start};
      const LidarPacket* packet = feed(decoder, sensor);
      ASSERT_NE(packet, nullptr);
      for (std::size_t i = 0; i < 384; ++i) {
        const LidarPoint& p = packet->points[i];
        const double azimuth = (start + step * p.time_offset_ns / 110'592.0) * 0.01 * kRadPerDeg;
        const double elevation = kElevationDeg[i % 16] * kRadPerDeg;
        EXPECT_NEAR(p.x, 10.0 * std::cos(elevation) * std::cos(azimuth), 1e-5);
        EXPECT_NEAR(p.y, -10.0 * std::cos(elevation) * std::sin(azimuth), 1e-5);
        EXPECT_NEAR(p.z, 10.0 * std::sin(elevation) + kHeightM[i % 16], 1e-5);
      }
    }
  }
}

TEST(Vlp16Decoder, CrossesTheSeamWithoutAWrongAzimuth) {
  Vlp16Decoder decoder{{}};
  Turning sensor{kStep600, 0x37, 0, 35990};
  const LidarPacket* packet = feed(decoder, sensor);
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->azimuth_begin_cdeg, 35990);
  for (std::size_t i = 0; i < packet->point_count; ++i) {
    const LidarPoint& p = packet->points[i];
    EXPECT_LT(p.azimuth_cdeg, 36000);
    const double turned = std::fmod(p.azimuth_cdeg - 35990 + 36000, 36000);
    EXPECT_NEAR(turned, kStep600 * p.time_offset_ns / 110'592.0, 0.51);
  }
}

TEST(Vlp16Decoder, InterpolatesEachBlockWithItsOwnStep) {
  Vlp16Bytes b{0, 40, 0};
  b.fill_returns(5000);
  b.set_azimuth(1, 42);  // steps 42, 38, 40, ...
  Vlp16Decoder decoder{{}};
  const LidarPacket* packet = decoder.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->points[16].azimuth_cdeg, 21);             // half of 42
  EXPECT_EQ(packet->points[48].azimuth_cdeg, 61);             // 42 and half of 38
  EXPECT_EQ(packet->points[11 * 32 + 16].azimuth_cdeg, 460);  // 440 and half of the mean
}

TEST(Vlp16Decoder, TurnsFrom300To1200RpmAndSaysHowFast) {
  for (const auto& [step, rpm] : {std::pair{20, 301.4}, {40, 602.8}, {80, 1205.6}}) {
    Vlp16Decoder decoder{{}};
    Turning sensor{step};
    for (int i = 0; i < 200; ++i) ASSERT_NE(feed(decoder, sensor), nullptr) << step;
    EXPECT_NEAR(decoder.rotation_rpm(), rpm, 0.1);
    EXPECT_EQ(decoder.stats().lost, 0U);
  }
}

TEST(Vlp16Decoder, RefusesAStandingTooFastBackwardOrJumpingHead) {
  using enum LidarRejection;
  for (const auto& [step, cause] :
       {std::pair{0, kStopped}, {1, kStopped}, {17, kStopped}, {90, kTooFast}, {3000, kTooFast}, {35960, kStopped}}) {
    Vlp16Decoder decoder{{}};
    Turning sensor{step};
    EXPECT_EQ(feed(decoder, sensor), nullptr);
    EXPECT_EQ(decoder.last_rejection(), cause) << step;
    EXPECT_EQ(decoder.stats().rejections[cause], 1U);
  }
  Vlp16Decoder decoder{{}};
  Vlp16Bytes b{0, 40, 0};
  b.set_azimuth(6, 9000);
  EXPECT_EQ(decoder.decode(b.span(), from_ns<HostTime>(kStartNs)), nullptr);
  EXPECT_EQ(decoder.last_rejection(), kAzimuthJump);
}

TEST(Vlp16Decoder, RefusesAPacketThatDoesNotContinueTheOneBefore) {
  Vlp16Decoder decoder{{}};
  Turning sensor;
  for (int i = 0; i < 5; ++i) ASSERT_NE(feed(decoder, sensor), nullptr);
  Vlp16Bytes turned = sensor.next();
  for (std::size_t block = 0; block < 12; ++block) {
    turned.set_azimuth(block, static_cast<std::uint16_t>(20000 + 40 * block));
  }
  EXPECT_EQ(decoder.decode(turned.span(), sensor.arrival()), nullptr);
  EXPECT_EQ(decoder.last_rejection(), LidarRejection::kAzimuthJump);
  EXPECT_NE(feed(decoder, sensor), nullptr);
}

TEST(Vlp16Decoder, CountsLostPacketsByTheirStamps) {
  for (const std::uint8_t mode : {std::uint8_t{0x37}, std::uint8_t{0x39}}) {
    Vlp16Decoder decoder{{}};
    Turning sensor{kStep600, mode};
    ASSERT_NE(feed(decoder, sensor), nullptr);
    sensor.skip(1);
    ASSERT_NE(feed(decoder, sensor), nullptr);
    EXPECT_EQ(decoder.stats().lost, 1U);
    sensor.skip(2260);  // three seconds
    ASSERT_NE(feed(decoder, sensor), nullptr);
    EXPECT_EQ(decoder.stats().lost, 2261U);
  }
}

TEST(Vlp16Decoder, RefusesRepeatedAndLatePackets) {
  Vlp16Decoder decoder{{}};
  Turning sensor;
  const Vlp16Bytes first = sensor.next();
  const Vlp16Bytes second = sensor.next();
  EXPECT_NE(decoder.decode(second.span(), sensor.arrival()), nullptr);
  EXPECT_EQ(decoder.decode(second.span(), sensor.arrival()), nullptr);
  EXPECT_EQ(decoder.decode(first.span(), sensor.arrival()), nullptr);
  EXPECT_EQ(decoder.stats().rejections[LidarRejection::kOutOfOrder], 2U);
}

TEST(Vlp16Decoder, GoesThroughTheEndOfTheHourWithoutLossOrJump) {
  Vlp16Decoder decoder{{}};
  Turning sensor{kStep600, 0x37, 3'600'000'000U - 2990 * kPeriodUs};
  HostTime previous{HostTime::min()};
  for (int i = 0; i < 3000; ++i) {
    const LidarPacket* packet = feed(decoder, sensor);
    ASSERT_NE(packet, nullptr);
    if (i > 2000) {  // the clock has settled; the hour ends at about 2990
      EXPECT_NEAR(to_seconds(packet->time - previous), 1327.104e-6, 2e-6);
    }
    previous = packet->time;
  }
  EXPECT_EQ(decoder.stats().lost, 0U);
  EXPECT_EQ(decoder.stats().clock_jumps, 0U);
}

TEST(Vlp16Decoder, PutsHostTimeAtTheFirstFiringAndNeverAfterTheArrival) {
  Vlp16Decoder decoder{{}};
  Turning sensor;
  for (int i = 0; i < 3000; ++i) {
    const LidarPacket* packet = feed(decoder, sensor);
    ASSERT_NE(packet, nullptr);
    EXPECT_LE(packet->time + packet->span, packet->arrival);
  }
  const LidarPacket* packet = feed(decoder, sensor);
  const Duration delay = packet->arrival - (packet->time + packet->span);  // latency as configured, +-1 us of the stamp
  EXPECT_NEAR(static_cast<double>(delay.count()), 30e3, 3e3);
}

TEST(Vlp16Decoder, DoubtsACorruptedStampOnceAndBelievesASetClock) {
  Vlp16Decoder decoder{{}};
  Turning sensor;
  for (int i = 0; i < 10; ++i) ASSERT_NE(feed(decoder, sensor), nullptr);
  Vlp16Bytes corrupted = sensor.next();
  corrupted.set_stamp(900'000'000U);
  EXPECT_EQ(decoder.decode(corrupted.span(), sensor.arrival()), nullptr);
  EXPECT_EQ(decoder.last_rejection(), LidarRejection::kStampJump);
  EXPECT_NE(feed(decoder, sensor), nullptr);
  EXPECT_EQ(decoder.stats().clock_jumps, 0U);
  EXPECT_EQ(decoder.stats().lost, 1U);

  for (std::uint32_t i = 0; i < 3; ++i) {
    Vlp16Bytes set = sensor.next();
    set.set_stamp(1'200'000'000U + i * kPeriodUs);
    EXPECT_EQ(decoder.decode(set.span(), sensor.arrival()) != nullptr, i > 0);
  }
  EXPECT_EQ(decoder.stats().clock_jumps, 1U);
}

TEST(Vlp16Decoder, KeepsReturnsInsideItsRangeLimitsOnly) {
  LidarDecoderConfig config;
  config.min_range_m = 1.0;
  config.max_range_m = 100.0;
  Vlp16Decoder decoder{config};
  Vlp16Bytes b{0, 40, 0};
  const std::pair<std::uint16_t, bool> cases[] = {{0, false},    {1, false},     {499, false},  {500, true},
                                                  {50000, true}, {50001, false}, {65535, false}};
  for (std::size_t i = 0; i < std::size(cases); ++i) b.set_return(0, i, cases[i].first, 9);
  const LidarPacket* packet = decoder.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(packet, nullptr);
  ASSERT_EQ(packet->point_count, 2);
  EXPECT_EQ(packet->points[0].time_offset_ns, 3 * 2304);
  EXPECT_EQ(packet->points[1].time_offset_ns, 4 * 2304);
  EXPECT_EQ(decoder.stats().out_of_range, 4U);
}

TEST(Vlp16Decoder, BeginsRaysAtTheManualsHeightsOrAtOnePoint) {
  LidarDecoderConfig one_point;
  one_point.vertical_offsets = false;
  Vlp16Decoder real{{}}, simple{one_point};
  Vlp16Bytes b{0, 40, 0};
  for (std::size_t i = 0; i < 16; ++i) b.set_return(0, i, 5000, 9);
  const LidarPacket* with = real.decode(b.span(), from_ns<HostTime>(kStartNs));
  const LidarPacket* without = simple.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(with, nullptr);
  ASSERT_NE(without, nullptr);
  ASSERT_EQ(with->point_count, 16);
  for (std::size_t i = 0; i < 16; ++i) {
    const LidarPoint &p = with->points[i], &q = without->points[i];
    EXPECT_NEAR(p.z - q.z, 0.0112 * (7.5 - p.ring) / 7.5, 3e-4) << "ring " << int{p.ring};
    EXPECT_NEAR(std::hypot(q.x, q.y, q.z), 10.0, 1e-5);
    EXPECT_EQ(p.x, q.x);
  }
}

TEST(Vlp16Decoder, AcceptsAPacketWithoutAnyReturn) {
  Vlp16Decoder decoder{{}};
  const Vlp16Bytes b{0, 40, 0};
  const LidarPacket* packet = decoder.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->point_count, 0);
  EXPECT_EQ(packet->azimuth_end_cdeg, 440 + 33);  // 40 * (55.296 + 15 * 2.304) / 110.592
}

TEST(Vlp16Decoder, GivesBothBlocksOfADualReturnPairTheSameFiringTimes) {
  Vlp16Bytes b{0, 40, 0, 0x39};
  b.set_return(4, 3, 6000, 10);  // pair 2: last return farther and darker
  b.set_return(5, 3, 5000, 90);
  b.set_return(4, 4, 6000, 90);  // last is the strongest: the odd block has the second strongest
  b.set_return(5, 4, 5000, 10);
  b.set_return(4, 5, 5000, 50);  // only one return: sent twice
  b.set_return(5, 5, 5000, 50);
  b.set_return(4, 6, 7000, 50);  // equally bright
  b.set_return(5, 6, 5000, 50);
  b.set_return(4, 7, 0, 0);  // the other one alone
  b.set_return(5, 7, 5000, 50);
  Vlp16Decoder decoder{{}};
  const LidarPacket* packet = decoder.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->span, Duration{663'552});

  struct Expected {
    int channel, distance, index;
  };
  constexpr Expected kExpected[] = {{3, 5000, 0}, {3, 6000, 1}, {4, 6000, 0}, {4, 5000, 1},
                                    {5, 5000, 0}, {6, 5000, 0}, {6, 7000, 1}, {7, 5000, 0}};
  ASSERT_EQ(packet->point_count, std::size(kExpected));
  for (std::size_t i = 0; i < std::size(kExpected); ++i) {
    const LidarPoint& p = packet->points[i];
    EXPECT_EQ(p.time_offset_ns, 2 * 110'592 + kExpected[i].channel * 2304);
    EXPECT_NEAR(std::hypot(p.x, p.y, p.z), kExpected[i].distance * 0.002, 0.004);
    EXPECT_EQ(p.return_index, kExpected[i].index) << i;
  }
}

TEST(Vlp16Decoder, HoldsTwoDifferentReturnsOfEveryFiring) {
  Vlp16Bytes b{0, 40, 0, 0x39};
  b.fill_returns(5000);
  for (std::size_t block = 1; block < 12; block += 2) {
    for (std::size_t channel = 0; channel < 32; ++channel) b.set_return(block, channel, 4000, 200);
  }
  Vlp16Decoder decoder{{}};
  const LidarPacket* packet = decoder.decode(b.span(), from_ns<HostTime>(kStartNs));
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->point_count, LidarPacket::kMaxPoints);
}

}  // namespace
}  // namespace slamd
