// The bytes slam-sim makes: repeatable, in order of arrival, and read back by our own drivers as the truth they came
// from.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "drivers/velodyne/vlp16_decoder.hpp"
#include "firmware/protocol/imu_frame.hpp"
#include "tools/slam-sim/motion/euler.hpp"
#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {
namespace {

std::vector<WireEvent> run(const DriveSpec& spec) {
  Simulation simulation{spec};
  std::vector<WireEvent> events;
  while (!simulation.done()) {
    for (WireEvent& event : simulation.next_slice()) events.push_back(std::move(event));
  }
  return events;
}

DriveSpec short_drive() {
  DriveSpec spec;
  spec.world = WorldKind::kParking;
  spec.crowd = 6;
  spec.course.rest_s = 0.3;
  spec.max_duration_s = 1.3;
  spec.threads = 1;
  return spec;
}

bool equal(const std::vector<WireEvent>& a, const std::vector<WireEvent>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const WireEvent& x, const WireEvent& y) {
    return x.channel == y.channel && x.taken_ns == y.taken_ns && x.arrival_ns == y.arrival_ns && x.bytes == y.bytes;
  });
}

TEST(SimWire, TheSameSeedGivesTheSameBytesWhateverTheNumberOfThreads) {
  DriveSpec spec = short_drive();
  const auto one = run(spec);
  spec.threads = 3;
  EXPECT_TRUE(equal(one, run(spec)));
  spec.seed = 2;
  EXPECT_FALSE(equal(one, run(spec)));
}

TEST(SimWire, EventsComeInOrderOfArrivalAndNeverBeforeTheyWereMeasured) {
  std::int64_t last = 0;
  for (const WireEvent& event : run(short_drive())) {
    EXPECT_GE(event.arrival_ns, last);
    EXPECT_GT(event.arrival_ns, event.taken_ns);
    last = event.arrival_ns;
  }
}

TEST(SimWire, SwitchingOneSensorOffLeavesTheBytesOfTheOthers) {
  DriveSpec spec = short_drive();
  const auto all = run(spec);
  spec.with_imu = spec.with_gps = false;
  const auto lidar = run(spec);
  std::vector<WireEvent> expected;
  for (const WireEvent& event : all) {
    if (event.channel == Channel::kLidar || event.channel == Channel::kPosition) expected.push_back(event);
  }
  EXPECT_FALSE(lidar.empty());
  EXPECT_TRUE(equal(lidar, expected));
}

/// Distance of a point in the corridor's world frame to its nearest face.
double to_corridor_face(const Eigen::Vector3d& p) {
  return std::min({std::abs(p.z()), std::abs(p.z() - 3.2), std::abs(std::abs(p.y()) - 2.6), std::abs(p.x() + 150.0),
                   std::abs(p.x() - 270.0)});
}

struct Corridor {
  std::size_t points = 0;
  double worst_m = 0.0;
  std::uint64_t refused = 0;
};

/// Decodes a noise-free drive along the corridor and puts every point into the world with the true pose of its firing.
Corridor decode_corridor(LidarModel lidar, const Mounting& mounting = {}) {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kLineAndBack;
  spec.course.rest_s = 0.1;
  spec.max_duration_s = 3.0;
  spec.lidar = lidar;
  spec.lidar.range_noise_m = 0.0;
  spec.mounting = mounting;
  spec.with_imu = spec.with_gps = false;
  Simulation simulation{spec};
  Vlp16Decoder decoder{LidarDecoderConfig{}};
  Corridor result;
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      if (event.channel != Channel::kLidar) continue;
      const LidarPacket* packet = decoder.decode(event.bytes, HostTime{Duration{event.arrival_ns}});
      if (packet == nullptr) continue;
      for (std::size_t i = 0; i < packet->point_count; ++i) {
        const LidarPoint& point = packet->points[i];
        const Eigen::Vector3d p_lidar(point.x, point.y, point.z);
        if (p_lidar.norm() > 12.0) continue;
        const double t = static_cast<double>(event.taken_ns + point.time_offset_ns) * 1e-9;
        const Pose T_world_lidar = simulation.trajectory().pose_at(t) * simulation.vehicle().T_base_lidar;
        result.worst_m = std::max(result.worst_m, to_corridor_face(T_world_lidar * p_lidar));
        ++result.points;
      }
    }
  }
  result.refused = decoder.stats().received - decoder.stats().accepted;
  return result;
}

TEST(SimWire, OurDecoderPutsEveryPointBackOntoTheWallItCameFrom) {
  for (const double rpm : {300.0, 600.0, 1200.0}) {
    LidarModel lidar;
    lidar.rpm = rpm;
    const Corridor result = decode_corridor(lidar);
    EXPECT_GT(result.points, 200'000U);
    EXPECT_LT(result.worst_m, 0.004) << rpm;  // 2 mm steps and 0.01 degree steps at 12 m
    EXPECT_EQ(result.refused, 0U);
  }
}

TEST(SimWire, DualReturnPacketsAreUnderstoodToo) {
  LidarModel lidar;
  lidar.mode = ReturnMode::kDual;
  const Corridor result = decode_corridor(lidar);
  EXPECT_GT(result.points, 200'000U);
  EXPECT_LT(result.worst_m, 0.004);
  EXPECT_EQ(result.refused, 0U);
}

TEST(SimWire, ALidarMountedElsewhereSeesTheWallsFromThere) {
  Mounting mounting;
  mounting.told.T_base_lidar = {from_roll_pitch_yaw({0.2, -0.1, 2.5}), {-0.5, 0.3, 1.1}};
  EXPECT_LT(decode_corridor({}, mounting).worst_m, 0.004);
}

TEST(SimWire, ATiltThatNobodyWasToldDisplacesWhatItSees) {
  Mounting mounting;
  mounting.lidar_tilt_rad.y() = 0.02;
  const Corridor result = decode_corridor({}, mounting);
  EXPECT_GT(result.worst_m, 0.15);  // 12 m times 0.02
  EXPECT_LT(result.worst_m, 0.30);
}

/// Every return of one revolution: azimuth in degrees, range in metres.
std::vector<std::pair<double, double>> returns_at_rest(const LidarModel& lidar) {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kStandstill;
  spec.max_duration_s = 0.1;
  spec.with_imu = spec.with_gps = false;
  spec.lidar = lidar;
  std::vector<std::pair<double, double>> returns;
  for (const WireEvent& event : run(spec)) {
    if (event.channel != Channel::kLidar) continue;
    const auto parsed = parse_vlp16(event.bytes);
    for (std::size_t block = 0; block < 12; ++block) {
      for (std::size_t channel = 0; channel < 32; ++channel) {
        const double range_m = 0.002 * parsed.packet.at(block, channel).distance_2mm;
        if (range_m > 0.0) returns.emplace_back(0.01 * parsed.packet.azimuth_cdeg[block], range_m);
      }
    }
  }
  return returns;
}

TEST(SimWire, NothingReturnsFromABlindSector) {
  LidarModel lidar;
  const std::size_t all = returns_at_rest(lidar).size();
  lidar.blind_from_deg = 300.0;  // over zero
  lidar.blind_to_deg = 60.0;
  const auto returns = returns_at_rest(lidar);
  EXPECT_GT(returns.size(), all / 2);
  for (const auto& [azimuth_deg, range_m] : returns) {
    EXPECT_GT(azimuth_deg, 59.0);  // the azimuth told is that of a block's first firing
    EXPECT_LT(azimuth_deg, 300.0);
  }
}

TEST(SimWire, RainReturnsItsShareOfTheFiringsFromNearby) {
  LidarModel lidar;
  const auto near = [](const auto& returns) {
    return static_cast<double>(std::ranges::count_if(returns, [](const auto& r) { return r.second < 1.2; }));
  };
  const auto clear = returns_at_rest(lidar);
  lidar.clutter = 0.2;
  const auto rainy = returns_at_rest(lidar);
  EXPECT_EQ(near(clear), 0.0);
  EXPECT_NEAR(near(rainy) / static_cast<double>(rainy.size()), 0.2 * (1.0 - std::exp(-0.7 / 4.0)), 0.01);
}

TEST(SimWire, RangeNoiseHasTheStandardDeviationItWasGiven) {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kStandstill;
  spec.max_duration_s = 1.0;
  spec.with_imu = spec.with_gps = false;
  spec.lidar.range_noise_m = 0.02;
  spec.lidar.divergence_rad = 0.0;
  const auto noisy = run(spec);
  spec.lidar.range_noise_m = 0.0;
  const auto exact = run(spec);
  double sum = 0.0, squares = 0.0, count = 0.0;
  ASSERT_EQ(noisy.size(), exact.size());
  for (std::size_t e = 0; e < noisy.size(); ++e) {
    if (noisy[e].channel != Channel::kLidar) continue;
    const auto a = parse_vlp16(noisy[e].bytes), b = parse_vlp16(exact[e].bytes);
    for (std::size_t channel = 0; channel < 32; ++channel) {
      if (a.packet.at(3, channel).distance_2mm == 0 || b.packet.at(3, channel).distance_2mm == 0) continue;
      const double error = 0.002 * (a.packet.at(3, channel).distance_2mm - b.packet.at(3, channel).distance_2mm);
      sum += error;
      squares += error * error;
      count += 1.0;
    }
  }
  ASSERT_GT(count, 10'000.0);
  EXPECT_NEAR(sum / count, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.001);
}

TEST(SimWire, PositionPacketsCarryClockPpsAndSentence) {
  DriveSpec spec = short_drive();
  spec.lidar.pps_locked = true;
  int seen = 0;
  for (const WireEvent& event : run(spec)) {
    if (event.channel != Channel::kPosition) continue;
    const auto position = parse_vlp16_position(event.bytes);
    ASSERT_TRUE(position);
    EXPECT_EQ(position->pps, PpsState::kLocked);
    EXPECT_NEAR(position->stamp_us, static_cast<double>(event.taken_ns) * 1e-3,
                2.0);  // the drive starts on a full hour
    EXPECT_EQ(position->nmea.substr(0, 7), "$GPRMC,");
    ++seen;
  }
  EXPECT_GT(seen, 60);
}

TEST(SimWire, ImuFramesCountUpAndRestAtOneGravity) {
  DriveSpec spec = short_drive();
  spec.course.kind = CourseKind::kStandstill;
  spec.imu.ideal = true;
  int sequence = 0;
  std::uint64_t last_us = 0;
  for (const WireEvent& event : run(spec)) {
    if (event.channel != Channel::kImu) continue;
    ASSERT_EQ(event.bytes.size(), kImuFrameWireBytes);
    const auto decoded = decode_imu_packet(std::span<const std::uint8_t>{event.bytes}.first(kImuFramePacketBytes));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded.frame.sequence, sequence++);
    EXPECT_GT(decoded.frame.device_us, last_us);
    last_us = decoded.frame.device_us;
    double force = 0.0;
    for (const auto counts : decoded.frame.accel) force += std::pow(counts * kImuAccelMgPerLsb * 1e-3, 2);
    EXPECT_NEAR(std::sqrt(force), 1.0, 2e-4);
    for (const auto counts : decoded.frame.gyro) EXPECT_EQ(counts, 0);
  }
  EXPECT_NEAR(sequence, 260, 1);  // 200 Hz by a clock of its own
}

TEST(SimWire, EverySentenceHasARightChecksumAndALineEnd) {
  DriveSpec spec = short_drive();
  spec.gps.sentences = "GGA,RMC,GSA,GST,VTG,ZDA";
  std::map<std::string, int> kinds;
  for (const WireEvent& event : run(spec)) {
    if (event.channel != Channel::kGps) continue;
    const std::string text(event.bytes.begin(), event.bytes.end());
    const auto star = text.find('*');
    ASSERT_NE(star, std::string::npos);
    unsigned sum = 0;
    for (std::size_t i = 1; i < star; ++i) sum ^= static_cast<unsigned char>(text[i]);
    EXPECT_EQ(std::stoul(text.substr(star + 1, 2), nullptr, 16), sum) << text;
    EXPECT_EQ(text.substr(star + 3), "\r\n");
    EXPECT_LE(text.size(), 82U);
    ++kinds[text.substr(3, 3)];
  }
  EXPECT_EQ(kinds.size(), 6U);
  EXPECT_EQ(kinds["GGA"], 2);
}

TEST(SimWire, AnglesOfSentencesNeverShowSixtyMinutes) {
  NmeaFix fix;
  fix.latitude_deg = 47.99999999999;
  fix.longitude_deg = -0.00000000001;
  EXPECT_NE(gga(fix).find(",4800.00000,N,00000.00000,W,"), std::string::npos) << gga(fix);
  fix.quality = 0;
  EXPECT_NE(rmc(fix).find(",V,"), std::string::npos);
}

}  // namespace
}  // namespace slamd::sim
