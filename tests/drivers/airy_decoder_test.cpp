#include "drivers/robosense/airy_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "drivers/robosense/airy_imu_parser.hpp"
#include "drivers/robosense/airy_stamp.hpp"
#include "drivers/robosense/airy_timing.hpp"
#include "tests/drivers/airy_bytes.hpp"

namespace slamd {
namespace {

using namespace test;
using std::chrono::microseconds;

constexpr HostTime kStart{std::chrono::seconds{500}};
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// A decoder that knows its beams, and time that goes on from packet to packet.
struct AiryRun {
  AiryDecoder decoder{{}};
  std::int64_t us = 0;
  int azimuth_cdeg = 0;

  AiryRun() { EXPECT_TRUE(decoder.inform(airy_device_packet())); }
  const LidarPacket* next(const std::function<void(Bytes&)>& change = [](Bytes&) {}, bool dual = false) {
    Bytes packet = airy_packet(static_cast<std::uint64_t>(us / 1'000'000), static_cast<std::uint32_t>(us % 1'000'000), azimuth_cdeg, 40, dual);
    change(packet);
    const LidarPacket* out = decoder.decode(packet, kStart + microseconds{us + 500});
    us += dual ? 222 : 444;
    azimuth_cdeg = (azimuth_cdeg + (dual ? 80 : 160)) % 36000;
    return out;
  }
};

TEST(AiryDecoder, PlacesAnEchoWhereItsBeamLooked) {
  AiryRun run;
  run.azimuth_cdeg = 9'000;
  const LidarPacket* out = run.next([](Bytes& b) {
    put_echo(b, 0, 0, 2'000, 17);              // channel 0: level, azimuth 90 degrees: to the right
    put_echo(b, 3, 2, 400 | 0x4000, 99);       // column 1, channel 50: 45 degrees up; a quality bit above the distance
  });
  ASSERT_NE(out, nullptr);
  ASSERT_EQ(out->point_count, 2);
  const LidarPoint& level = out->points[0];
  EXPECT_NEAR(level.x, 0.0, 1e-5);
  EXPECT_NEAR(level.y, -10.0 - 0.011433, 1e-5);
  EXPECT_NEAR(level.z, 0.06056, 1e-6);
  EXPECT_EQ(level.intensity, 17);
  EXPECT_EQ(level.ring, 0);
  EXPECT_EQ(level.azimuth_cdeg, 9'000);
  EXPECT_EQ(level.time_offset_ns, 0);
  const LidarPoint& up = out->points[1];
  const double azimuth = (90.4 + 0.4 * 52.360 / 111.08) * kRadPerDeg;  // channel 50 fires in the seventh group
  EXPECT_NEAR(up.z, 2.0 * std::sin(45.0 * kRadPerDeg) + 0.06056, 1e-5);
  EXPECT_NEAR(up.x, (2.0 * std::cos(45.0 * kRadPerDeg) + 0.011433) * std::cos(azimuth), 1e-5);
  EXPECT_EQ(up.ring, 50);
  EXPECT_EQ(up.time_offset_ns, 111'080 + 52'360);
  EXPECT_EQ(out->span, Duration{4 * 111'080});
  EXPECT_EQ(out->azimuth_begin_cdeg, 9'000);
}

TEST(AiryDecoder, TakesUnevenAnglesOfAUnitAndCountsRingsFromBelow) {
  AiryRun run;
  Bytes device = airy_device_packet();
  store_be(device, 469, 9'000, 2);        // channel 0 looks straight up now
  store_be(device, 756 + 3 * 5 + 1, 150, 2);  // channel 5 to the left by 1.5 degrees
  device[756 + 3 * 5] = 1;
  ASSERT_TRUE(run.decoder.inform(device));
  const LidarPacket* out = run.next([](Bytes& b) {
    put_echo(b, 0, 0, 1'000, 1);
    put_echo(b, 0, 5, 1'000, 1);
  });
  ASSERT_NE(out, nullptr);
  ASSERT_EQ(out->point_count, 2);
  EXPECT_EQ(out->points[0].ring, 95);
  EXPECT_NEAR(out->points[0].z, 5.06056, 1e-5);
  EXPECT_EQ(out->points[1].ring, 4);
  EXPECT_EQ(out->points[1].azimuth_cdeg, 35'850);
  EXPECT_NEAR(std::atan2(out->points[1].y, out->points[1].x), 1.5 * kRadPerDeg, 1e-4);
}

TEST(AiryDecoder, GivesBothReturnsOfAPairTheBrighterOneFirst) {
  AiryRun run;
  const LidarPacket* out = run.next(
      [](Bytes& b) {
        put_echo(b, 4, 1, 1'000, 10);  // column 1: blocks 4, 5 and 6, 7
        put_echo(b, 6, 1, 1'200, 40);
        put_echo(b, 5, 0, 800, 7);
        put_echo(b, 7, 0, 800, 7);
      },
      true);
  ASSERT_NE(out, nullptr);
  ASSERT_EQ(out->point_count, 3);
  EXPECT_EQ(out->points[0].intensity, 40);
  EXPECT_EQ(out->points[0].return_index, 0);
  EXPECT_EQ(out->points[1].intensity, 10);
  EXPECT_EQ(out->points[1].return_index, 1);
  EXPECT_EQ(out->points[2].ring, 48);
  EXPECT_EQ(out->span, Duration{2 * 111'080});
}

TEST(AiryDecoder, RefusesByCause) {
  struct Case {
    LidarRejection cause;
    std::function<void(Bytes&)> change;
  };
  const std::vector<Case> cases{{LidarRejection::kWrongSize, [](Bytes& b) { b.pop_back(); }},
                                {LidarRejection::kHeader, [](Bytes& b) { b[3] = 0; }},
                                {LidarRejection::kDataType, [](Bytes& b) { b[16] = 1; }},
                                {LidarRejection::kUnknownModel, [](Bytes& b) { b[32] = 1; }},
                                {LidarRejection::kUnknownModel, [](Bytes& b) { b[32] = 3; }},
                                {LidarRejection::kStampRange, [](Bytes& b) { store_be(b, 26, 1'000'000, 4); }},
                                {LidarRejection::kBlockFlag, [](Bytes& b) { b[42 + 7 * 148] = 0; }},
                                {LidarRejection::kAzimuthRange, [](Bytes& b) { store_be(b, 44, 36'000, 2); }},
                                {LidarRejection::kPairMismatch, [](Bytes& b) { store_be(b, 44 + 148, 35'999, 2); }},
                                {LidarRejection::kAzimuthJump, [](Bytes& b) {
                                   store_be(b, 44 + 6 * 148, 1'000, 2);
                                   store_be(b, 44 + 7 * 148, 1'000, 2);
                                 }}};
  for (const Case& c : cases) {
    AiryRun run;
    EXPECT_EQ(run.next(c.change), nullptr) << name(c.cause);
    EXPECT_EQ(run.decoder.last_rejection(), c.cause) << name(run.decoder.last_rejection());
    EXPECT_EQ(run.decoder.stats().rejections.total(), 1U);
  }
}

TEST(AiryDecoder, WaitsForTheDirectionsOfItsBeams) {
  AiryDecoder decoder{{}};
  EXPECT_EQ(decoder.decode(airy_packet(0, 0, 0), kStart), nullptr);
  EXPECT_EQ(decoder.last_rejection(), LidarRejection::kNoAngles);
  Bytes uncalibrated = airy_device_packet();
  uncalibrated[468] = 0xFF;
  EXPECT_FALSE(decoder.inform(uncalibrated));
  Bytes cut = airy_device_packet();
  cut[1247] = 0;
  EXPECT_FALSE(decoder.inform(cut));
  EXPECT_TRUE(decoder.inform(airy_device_packet()));
  EXPECT_NE(decoder.decode(airy_packet(0, 444, 160), kStart + microseconds{444}), nullptr);
}

TEST(AiryDecoder, CountsLostPacketsAndDoubtsStamps) {
  AiryRun run;
  for (int i = 0; i < 100; ++i) ASSERT_NE(run.next(), nullptr);
  run.us += 3 * 444;
  run.azimuth_cdeg += 3 * 160;
  ASSERT_NE(run.next(), nullptr);
  EXPECT_EQ(run.decoder.stats().lost, 3U);
  EXPECT_EQ(run.next([](Bytes& b) { store_be(b, 20, 77, 6); }), nullptr);
  EXPECT_EQ(run.decoder.last_rejection(), LidarRejection::kStampJump);
  EXPECT_NE(run.next(), nullptr);
}

TEST(AiryStamp, ReadsBothFormsAndRefusesWhatIsNoTime) {
  std::array<std::uint8_t, 10> count{0, 0, 0x65, 0x53, 0xF1, 0x00, 0, 0, 0, 25};
  EXPECT_EQ(to_ns(*read_robosense_stamp(count)), 0x6553F100LL * 1'000'000'000 + 25'000);
  std::array<std::uint8_t, 10> calendar{26, 11, 23, 12, 30, 45, 0x01, 0xF4, 0x00, 0x07};  // 2026-11-23 12:30:45.500007
  const auto day = std::chrono::sys_days{std::chrono::year{2026} / 11 / 23}.time_since_epoch();
  EXPECT_EQ(*read_robosense_stamp(calendar), DeviceTime{day + std::chrono::hours{12} + std::chrono::minutes{30} +
                                                        std::chrono::seconds{45} + microseconds{500'007}});
  for (const auto& [at, value] : {std::pair{1, 13}, {1, 0}, {2, 32}, {3, 24}, {4, 60}, {5, 61}, {6, 4}, {8, 4}}) {
    auto wrong = calendar;
    wrong[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(value);
    EXPECT_FALSE(read_robosense_stamp(wrong)) << at;
  }
}

TEST(AiryImuParser, GivesSiUnitsAndRefusesByCause) {
  AiryImuParser parser;
  std::vector<ImuSample> found;
  const auto feed = [&](const Bytes& bytes, int ms) {
    parser.feed(bytes, kStart + std::chrono::milliseconds{ms}, [&](const ImuSample& sample) { found.push_back(sample); });
  };
  feed(airy_imu_packet(10, 0, {8'192, 0, -16'384, 0, 32'767, -1}), 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].accel_mps2.x(), 9.80665, 1e-9);
  EXPECT_NEAR(found[0].accel_mps2.z(), -2.0 * 9.80665, 1e-9);
  EXPECT_NEAR(found[0].gyro_rads.y(), 32'767.0 / 32'768.0 * 500.0 * kRadPerDeg, 1e-9);
  EXPECT_TRUE(found[0].clipped);
  feed(airy_imu_packet(10, 0, {}), 2);
  EXPECT_EQ(parser.stats().repeated, 1U);
  feed(airy_imu_packet(99, 0, {}), 7);
  EXPECT_EQ(parser.stats().implausible, 1U);
  feed(airy_imu_packet(10, 20'000, {}), 21);
  EXPECT_EQ(parser.stats().missing, 3U);
  EXPECT_FALSE(found[1].clipped);
  Bytes other = airy_imu_packet(10, 25'000, {});
  other[44] = 9;
  feed(other, 26);
  feed(airy_imu_packet(10, 30'000, {40'000, 0, 0, 0, 0, 0}), 31);
  feed(Bytes(50), 32);
  EXPECT_EQ(parser.stats().malformed, 3U);
  EXPECT_EQ(found.size(), 2U);
}

}  // namespace
}  // namespace slamd
