// The small robot of slam-sim: its house leaves it room, it stays within its limits, its LiDAR and its wheels tell the truth but
// for the errors that they are given.

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "drivers/wheel/wheel_parser.hpp"
#include "tools/slam-replay/drive/scan_csv_reader.hpp"
#include "tools/slam-sim/output/scenarios.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

DriveSpec house(std::uint64_t seed, double duration_s = 0.0) {
  DriveSpec spec;
  find_scenario("house")->apply(spec);
  spec.seed = seed;
  spec.max_duration_s = duration_s;
  spec.with_imu = false;
  return spec;
}

std::vector<std::string> lines_of(Simulation& simulation, Channel channel) {
  std::vector<std::string> lines;
  while (!simulation.done()) {
    for (const WireEvent& event : simulation.next_slice()) {
      if (event.channel != channel) continue;
      lines.push_back(std::to_string(event.arrival_ns) + "," + std::string(event.bytes.begin(), event.bytes.end()));
    }
  }
  return lines;
}

/// To the nearest thing at any height of the robot.
double room_at(const World& world, const Eigen::Vector2d& p) {
  double nearest = 10.0;
  for (const double height : {0.05, 0.18}) {
    for (int i = 0; i < 180; ++i) {
      const double angle = i * std::numbers::pi / 90;
      const Hit hit = world.cast({{p.x(), p.y(), height}, {std::cos(angle), std::sin(angle), 0.0}, 10.0});
      nearest = std::min(nearest, hit.range);
    }
  }
  return nearest;
}

TEST(SimHouse, EveryHouseLeavesTheRobotItsWay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const World world = make_house(seed);
    for (const Eigen::Vector2d& p : world.loop.points) ASSERT_GT(room_at(world, p), 0.2) << "seed " << seed << " at " << p.transpose();
    EXPECT_GT(Path{world.loop}.length(), 15.0) << seed;
  }
}

TEST(SimHouse, NoTwoSeedsGiveTheSameHouse) {
  const World one = make_house(1), two = make_house(2);
  EXPECT_FALSE(one.bodies.bodies().size() == two.bodies.bodies().size() && one.loop.points.size() == two.loop.points.size());
}

TEST(SimHouse, TheRobotStaysWithinItsLimitsAndEndsWhereItBegan) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Simulation simulation{house(seed)};
    const Trajectory& truth = simulation.trajectory();
    for (double t = 0.0; t < truth.duration(); t += 0.05) {
      const Motion motion = truth.at(t);
      ASSERT_LE(motion.velocity.norm(), 0.22) << seed << " at " << t;
      ASSERT_LE(motion.rate.norm(), 2.84) << seed << " at " << t;
      const Vector3d sideways = motion.T_world_base.rotation.conjugate() * motion.velocity;
      ASSERT_LT(std::abs(sideways.y()), 0.005) << "a differential drive cannot move to its side";
    }
    EXPECT_LT((truth.pose_at(truth.duration()).translation - truth.pose_at(0.0).translation).norm(), 0.05);
  }
}

TEST(SimHouse, EveryRangeIsThatOfItsOwnInstant) {
  DriveSpec spec = house(3, 20.0);
  spec.planar_lidar.range_noise_m = 0.0;
  Simulation simulation{spec};
  std::stringstream text;
  for (const std::string& line : lines_of(simulation, Channel::kLidar)) text << line << "\n";
  replay::ScanCsvReader reader{text};
  int scans = 0;
  for (auto scan = reader.next(); scan; scan = reader.next(), ++scans) {
    ASSERT_EQ(scan->beams.size(), 360U);
    const double begin = std::round(to_seconds(scan->time.time_since_epoch()) / 0.2) * 0.2;  // the sensor's, without its latency
    for (const LaserBeam& beam : scan->beams) {
      const Pose T_world_lidar = simulation.trajectory().pose_at(begin + static_cast<double>(beam.time_s)) * simulation.vehicle().T_base_lidar;
      const double angle = static_cast<double>(beam.angle_rad);
      const Hit hit = simulation.world().cast({T_world_lidar.translation, T_world_lidar.rotation * Vector3d(std::cos(angle), std::sin(angle), 0.0), 10.0});
      const double range = static_cast<double>(beam.range_m);
      const bool unseen = range == 0.0 && (hit.range > 3.499 || hit.range < 0.121);
      ASSERT_TRUE(unseen || std::abs(range - hit.range) < 0.003) << range << " is " << hit.range;
    }
  }
  EXPECT_EQ(scans, 100);
  EXPECT_EQ(reader.bad_lines().count, 0U);
}

TEST(SimHouse, RangeNoiseIsAsTold) {
  DriveSpec spec = house(2, 10.0);
  spec.course.kind = CourseKind::kStandstill;
  spec.planar_lidar.range_noise_m = 0.01;
  Simulation noisy{spec};
  std::stringstream text;
  for (const std::string& line : lines_of(noisy, Channel::kLidar)) text << line << "\n";
  replay::ScanCsvReader reader{text};
  std::vector<double> sum(360), squares(360), count(360);
  for (auto scan = reader.next(); scan; scan = reader.next()) {
    for (std::size_t i = 0; i < 360; ++i) {
      const double range = static_cast<double>(scan->beams[i].range_m);
      if (range > 3.4 || range == 0.0) continue;
      sum[i] += range;
      squares[i] += range * range;
      ++count[i];
    }
  }
  double variance = 0.0, beams = 0.0;
  for (std::size_t i = 0; i < 360; ++i) {
    if (count[i] < 40) continue;
    variance += squares[i] / count[i] - std::pow(sum[i] / count[i], 2);
    ++beams;
  }
  ASSERT_GT(beams, 200);
  EXPECT_NEAR(std::sqrt(variance / beams), 0.01, 0.001);
}

/// The last odometry of the drive's sentences, through the driver.
WheelOdometry last_odometry(Simulation& simulation) {
  WheelParser parser;
  WheelOdometry last;
  for (const std::string& line : lines_of(simulation, Channel::kWheel)) {
    const std::size_t comma = line.find(',');
    const std::string sentence = line.substr(comma + 1);
    parser.feed({reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()},
                from_ns<HostTime>(std::stoll(line.substr(0, comma))), [&last](const WheelOdometry& odometry) { last = odometry; });
  }
  EXPECT_EQ(parser.line_stats().bad_checksum + parser.stats().malformed, 0U);
  EXPECT_GT(parser.track_stats().accepted, 1000U);
  return last;
}

DriveSpec without_wheel_errors(DriveSpec spec) {
  spec.with_lidar = false;
  spec.wheel.scale_percent = spec.wheel.balance_percent = spec.wheel.track_percent = spec.wheel.slip_m_rtm = 0.0;
  return spec;
}

TEST(SimHouse, WheelsWithoutErrorsIntegrateToTheTruth) {
  Simulation simulation{without_wheel_errors(house(1))};
  const WheelOdometry last = last_odometry(simulation);
  const Pose start = simulation.trajectory().pose_at(0.0);
  const Vector3d end = start.inverse() * simulation.trajectory().pose_at(simulation.duration()).translation;
  EXPECT_LT(std::hypot(last.x_m - end.x(), last.y_m - end.y()), 0.02);
  EXPECT_NEAR(last.yaw_rad, 4 * std::numbers::pi, 0.005) << "two rounds, and yaw does not wrap";
}

TEST(SimHouse, SlipMakesTheWheelsDriftAsTold) {
  double squares = 0.0;
  constexpr int kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    DriveSpec spec = without_wheel_errors(house(seed));
    spec.wheel.slip_m_rtm = 0.002;
    Simulation simulation{spec};
    const double wheels_m = simulation.trajectory().distance_at(simulation.duration());
    const double sigma = 0.002 * std::sqrt(2 * wheels_m) / spec.wheel.track_m;
    squares += std::pow((last_odometry(simulation).yaw_rad - 4 * std::numbers::pi) / sigma, 2);
  }
  EXPECT_GT(squares / kSeeds, 0.35);
  EXPECT_LT(squares / kSeeds, 2.2);
}

TEST(SimHouse, TheSameSeedGivesTheSameBytes) {
  Simulation one{house(4, 10.0)}, two{house(4, 10.0)};
  EXPECT_EQ(lines_of(one, Channel::kLidar), lines_of(two, Channel::kLidar));
}

TEST(SimLoop, TheGroundsAreSoLargeAsThePapers) {
  const World world = make_grounds(1);
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : world.loop.points) box.extend(p);
  EXPECT_NEAR(box.sizes().x(), 560.0, 15.0);
  EXPECT_NEAR(box.sizes().y(), 363.0, 15.0);
}

}  // namespace
}  // namespace slamd::sim
