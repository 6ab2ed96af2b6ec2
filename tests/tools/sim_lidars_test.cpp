// The bytes of the simulated Airy and RPLIDAR A2, read back by their drivers as the truth they came from; and the A2's driver against
// the simulated firmware on the other end of its serial port.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/lidar/spinning_lidar.hpp"
#include "drivers/robosense/airy_imu_parser.hpp"
#include "drivers/rplidar/rplidar_parser.hpp"
#include "drivers/rplidar/rplidar_session.hpp"
#include "tools/slam-sim/sensors/airy_sensor.hpp"
#include "tools/slam-sim/sensors/rplidar_device.hpp"
#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

HostTime at(std::int64_t ns) { return HostTime{Duration{ns}}; }

DriveSpec parking(LidarKind kind, double duration_s) {
  DriveSpec spec;
  spec.world = WorldKind::kParking;
  spec.course.rest_s = 0.2;
  spec.max_duration_s = duration_s;
  spec.lidar_kind = kind;
  spec.lidar.range_noise_m = 0.0;
  spec.with_gps = false;
  spec.threads = 1;
  return spec;
}

/// How far the world lies from where a point was seen, along the ray from the sensor's place at that time.
double error_of(const Simulation& simulation, double t, const Vector3d& origin_lidar, const Vector3d& p_lidar) {
  const Pose T_world_lidar = simulation.trajectory().pose_at(t) * simulation.vehicle().T_base_lidar;
  const Vector3d ray = p_lidar - origin_lidar;
  const Hit hit = simulation.world().cast({T_world_lidar * origin_lidar, T_world_lidar.rotation * ray.normalized(), 80.0});
  return hit ? std::abs(hit.range - ray.norm()) : 80.0;
}

struct AiryChecked {
  std::size_t points = 0, far_off = 0, rings = 0;
  LidarStats stats;
};

AiryChecked check_airy(ReturnMode mode) {
  DriveSpec spec = parking(LidarKind::kAiry, 0.6);
  spec.lidar.mode = mode;
  Simulation simulation{spec};
  LidarDecoderConfig near;
  near.min_range_m = 0.2;
  SpinningLidar driver{slamd::LidarModel::kAiry, near};
  AiryChecked checked;
  std::array<bool, 128> seen{};
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      if (event.channel == Channel::kPosition) driver.side(event.bytes);
      const LidarPacket* packet = event.channel == Channel::kLidar ? driver.points(event.bytes, at(event.arrival_ns)) : nullptr;
      for (std::size_t i = 0; packet != nullptr && i < packet->point_count; ++i) {
        const LidarPoint& point = packet->points[i];
        const double t = static_cast<double>(event.taken_ns + point.time_offset_ns) * 1e-9;
        const double error = error_of(simulation, t, Vector3d(0.0, 0.0, 0.06056), Vector3d(point.x, point.y, point.z));
        ++checked.points;
        checked.far_off += error > 0.05 ? 1 : 0;  // at edges the driver's direction, told in 0.01 degrees, may miss
        seen[point.ring] = true;
      }
    }
  }
  checked.rings = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
  checked.stats = driver.stats();
  return checked;
}

TEST(SimAiry, EveryPointLiesWhereItsBeamMetTheWorld) {
  const AiryChecked checked = check_airy(ReturnMode::kStrongest);
  EXPECT_GT(checked.points, 100'000U);
  EXPECT_LT(checked.far_off, checked.points / 200);
  EXPECT_EQ(checked.rings, 96U);
  EXPECT_EQ(checked.stats.rejections.total(), checked.stats.rejections[LidarRejection::kNoAngles]);
  EXPECT_EQ(checked.stats.lost, 0U);
}

TEST(SimAiry, DualReturnOfEqualEchoesIsThatOfOne) {
  const AiryChecked checked = check_airy(ReturnMode::kDual);
  EXPECT_GT(checked.points, 100'000U);
  EXPECT_LT(checked.far_off, checked.points / 200);
}

TEST(SimAiry, ItsImuIsThatOfTheLidarsPlace) {
  DriveSpec spec = parking(LidarKind::kAiry, 1.5);
  spec.imu.ideal = true;
  spec.with_imu = false;
  Simulation simulation{spec};
  AiryImuParser parser;
  std::size_t samples = 0;
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      if (event.channel != Channel::kLidarImu) continue;
      parser.feed(event.bytes, at(event.arrival_ns), [&](const ImuSample& sample) {
        const double t = std::max(0.0, static_cast<double>(event.taken_ns) * 1e-9);
        const Inertial truth = inertial_at(simulation.trajectory().at(t), simulation.vehicle().T_base_imu, 9.80665);
        EXPECT_LT((sample.gyro_rads - truth.rate_rads).norm(), 0.01);
        EXPECT_LT((sample.accel_mps2 - truth.specific_force_mps2).norm(), 0.3);
        EXPECT_LT(std::abs(static_cast<double>(to_ns(sample.time) - event.taken_ns)), 3e6);
        ++samples;
      });
    }
  }
  EXPECT_GT(samples, 280U);
  EXPECT_EQ(parser.stats().malformed + parser.stats().implausible + parser.stats().missing, 0U);
}

/// The A2's driver and the simulated firmware, joined.
struct RplidarBench {
  Simulation simulation;
  RplidarDevice device;
  RplidarParser parser;
  RplidarSession session;
  std::vector<LaserScan> scans;

  explicit RplidarBench(RplidarFirmware firmware, double duration_s)
      : simulation{[&] {
          DriveSpec spec = parking(LidarKind::kRplidarA2, duration_s);
          spec.rplidar = firmware;
          spec.with_imu = false;
          return spec;
        }()},
        device{firmware},
        firmware_{firmware} {}

  void receive(std::span<const std::uint8_t> bytes, HostTime now) {
    parser.feed(bytes, now, [&](const LaserScan& scan) { scans.push_back(scan); },
                [&](const RplidarPacket& packet) { session.take(packet, now); });
    if (!bytes.empty()) session.heard(now);
  }
  /// The host's turn: requests out, answers in.
  void talk(HostTime now) {
    while (const std::optional<RplidarRequest> request = session.poll(now)) receive(device.take(request->view()), now);
  }
  /// unplugged  from when to when
  void run(double unplugged_from_s = 0.0, double unplugged_to_s = 0.0) {
    bool was_gone = false;
    while (!simulation.done()) {
      for (const WireEvent& event : simulation.next_slice()) {
        const HostTime now = at(event.arrival_ns);
        const double t = to_seconds(now.time_since_epoch());
        const bool gone = t >= unplugged_from_s && t < unplugged_to_s;
        if (was_gone && !gone) {  // it comes back powered up anew
          device = RplidarDevice{firmware_};
          parser.restart();
          session.restart();
        }
        was_gone = gone;
        if (gone) continue;
        talk(now);
        if (device.is_scanning()) receive(event.bytes, now);
      }
    }
  }

  RplidarFirmware firmware_;
};

/// Share of returns that are not where the world is, by more than 3 cm or 1 % of the range.
double share_off(const Simulation& simulation, const std::vector<LaserScan>& scans) {
  std::size_t points = 0, off = 0;
  for (const LaserScan& scan : scans) {
    for (const LaserBeam& beam : scan.beams) {
      if (beam.range_m == 0.0F) continue;
      const double t = to_seconds(scan.time.time_since_epoch()) + static_cast<double>(beam.time_s);
      const auto angle = static_cast<double>(beam.angle_rad), range = static_cast<double>(beam.range_m);
      const Vector3d p(range * std::cos(angle), range * std::sin(angle), 0.0);
      ++points;
      off += error_of(simulation, std::max(0.0, t), Vector3d::Zero(), p) > std::max(0.03, 0.01 * range) ? 1 : 0;
    }
  }
  return points == 0 ? 1.0 : static_cast<double>(off) / static_cast<double>(points);
}

struct FirmwareCase {
  RplidarFirmware firmware;
  std::size_t least_beams, most_beams;  // of a revolution at 10 Hz
  double share_off;                     // edges, and what the packing rounds
};

class SimRplidar : public testing::TestWithParam<FirmwareCase> {};

TEST_P(SimRplidar, ScansAreWhereTheWorldIs) {
  RplidarBench bench{GetParam().firmware, 8.0};
  bench.run();
  EXPECT_EQ(bench.session.step(), RplidarSession::Step::kRunning);
  EXPECT_EQ(bench.session.stats().starts, 1U);
  ASSERT_GT(bench.scans.size(), 20U);
  for (std::size_t i = 1; i < bench.scans.size(); ++i) {
    EXPECT_GE(bench.scans[i].beams.size(), GetParam().least_beams);
    EXPECT_LE(bench.scans[i].beams.size(), GetParam().most_beams);
    EXPECT_NEAR(to_seconds(bench.scans[i].time - bench.scans[i - 1].time), 0.1, 0.002);
  }
  EXPECT_LT(share_off(bench.simulation, bench.scans), GetParam().share_off);
  EXPECT_EQ(bench.parser.reader_stats().bad_checksum, 0U);
  EXPECT_EQ(bench.parser.gaps(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Firmwares, SimRplidar,
                         testing::Values(FirmwareCase{RplidarFirmware::kBoost, 799, 801, 0.05},
                                         FirmwareCase{RplidarFirmware::kExpress, 399, 401, 0.05},
                                         FirmwareCase{RplidarFirmware::kStandard, 199, 201, 0.05}));

TEST(SimRplidar, GoesOnAfterAnUnplug) {
  RplidarBench bench{RplidarFirmware::kBoost, 9.0};
  bench.run(4.0, 5.5);
  EXPECT_EQ(bench.session.step(), RplidarSession::Step::kRunning);
  EXPECT_EQ(bench.session.stats().starts, 2U);
  const auto last = to_seconds(bench.scans.back().time.time_since_epoch());
  EXPECT_GT(last, 8.5);
  EXPECT_LT(share_off(bench.simulation, bench.scans), 0.05);
}

TEST(SimRplidar, FindsItsPacketsAmongDamagedBytes) {
  RplidarBench bench{RplidarFirmware::kBoost, 6.0};
  Rng rng{5, Stream::kFault};
  while (!bench.simulation.done()) {
    for (WireEvent& event : bench.simulation.next_slice()) {
      bench.talk(at(event.arrival_ns));
      if (rng.chance(0.1)) event.bytes[static_cast<std::size_t>(rng.index(132))] ^= 0x10;
      if (rng.chance(0.05)) event.bytes.pop_back();
      if (bench.device.is_scanning()) bench.receive(event.bytes, at(event.arrival_ns));
    }
  }
  EXPECT_GT(bench.parser.reader_stats().bad_checksum, 5U);
  EXPECT_GT(bench.parser.gaps(), 5U);
  EXPECT_GT(bench.scans.size(), 20U);
  EXPECT_LT(share_off(bench.simulation, bench.scans), 0.06);
}

}  // namespace
}  // namespace slamd::sim
