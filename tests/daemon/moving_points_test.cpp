#include "daemon/store/moving_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "daemon/store/map_store.hpp"

namespace slamd {
namespace {

/// A street in odom: ground z = 0, a wall y = 12, a thin pole, a hedge-high wall y = -9, and one box that may move.
struct Street {
  double box_x = -1000.0;  // front lower corner; 4 x 1.8 x 1.6 m
  static constexpr double kBoxY = 4.0;

  /// Range along a ray; 0 when nothing comes back.
  double cast(const Eigen::Vector3d& from, const Eigen::Vector3d& along) const {
    double range = 90.0;
    const auto hit = [&](double t) { if (t > 0.5) range = std::min(range, t); };
    if (along.z() < 0) hit(-from.z() / along.z());
    hit(wall(from, along, 12.0, 6.0));
    hit(wall(from, along, -9.0, 1.2));
    hit(box(from, along, {30.0, -3.1, 0.0}, {30.2, -2.9, 4.0}));
    hit(box(from, along, {box_x, kBoxY, 0.0}, {box_x + 4.0, kBoxY + 1.8, 1.6}));
    return range < 90.0 ? range : 0.0;
  }

  static double wall(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double y, double height) {
    const double t = (y - from.y()) / along.y();
    return std::isfinite(t) && from.z() + t * along.z() < height ? t : -1.0;
  }

  static double box(const Eigen::Vector3d& from, const Eigen::Vector3d& along, const Eigen::Vector3d& low,
                    const Eigen::Vector3d& high) {
    const Eigen::Array3d a = (low - from).array() / along.array(), b = (high - from).array() / along.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter < leave ? enter : -1.0;
  }
};

/// A drive along x at 8 m/s, a keyframe every 1.6 m, each firing from where the sensor was at its time.
class StreetDrive {
 public:
  static constexpr double kSpeed_mps = 8.0, kPeriod_s = 0.2;

  Keyframe keyframe(std::uint64_t id, double box_begin_x, double box_speed_mps) {
    Keyframe keyframe;
    keyframe.id = id;
    const double end_s = static_cast<double>(id) * kPeriod_s;
    keyframe.state.T_odom_base.translation.x() = kSpeed_mps * end_s;
    keyframe.state.velocity_mps.x() = kSpeed_mps;
    keyframe.scan_span = std::chrono::milliseconds{100};
    for (int firing = 0; firing < 1800; ++firing) {
      const double before_s = 0.1 * (1.0 - firing / 1800.0);
      Street street{.box_x = box_begin_x + box_speed_mps * (end_s - before_s)};
      fire(street, firing, before_s, keyframe);
    }
    return keyframe;
  }

  Pose T_base_lidar() const {
    Pose pose;
    pose.translation.z() = kHeight_m;
    return pose;
  }

 private:
  static constexpr double kHeight_m = 1.9;

  void fire(const Street& street, int firing, double before_s, Keyframe& keyframe) {
    const double azimuth = -2.0 * M_PI * firing / 1800.0;
    const double x = keyframe.state.T_odom_base.translation.x();
    const Eigen::Vector3d from{x - kSpeed_mps * before_s, 0.0, kHeight_m};
    for (int ring = 0; ring < 16; ++ring) {
      const double elevation = (2.0 * ring - 15.0) * M_PI / 180.0;
      const Eigen::Vector3d along{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                  std::sin(elevation)};
      const double range = street.cast(from, along);
      if (range == 0.0) continue;
      const Eigen::Vector3d p = from + (range + noise_(random_)) * along;
      keyframe.points.push_back({static_cast<float>(p.x() - x), static_cast<float>(p.y()), static_cast<float>(p.z()), 9});
    }
  }

  std::mt19937 random_{5};
  std::normal_distribution<double> noise_{0.0, 0.02};
};

struct Shares {
  std::size_t box = 0, other = 0;
};

/// Points strictly inside the lane that the box drives in, and all others.
Shares count(const MapStore& store) {
  Shares shares;
  for (const CloudPoint& p : store.snapshot({}).points()) {
    const bool in_lane = p.y > Street::kBoxY - 0.2 && p.y < Street::kBoxY + 2.0 && p.z > 0.25F && p.z < 1.8F;
    ++(in_lane ? shares.box : shares.other);
  }
  return shares;
}

Shares drive(std::uint32_t witnesses, double box_begin_x, double box_speed_mps) {
  StreetDrive drive;
  MapStoreConfig config;
  config.moving.keyframes = witnesses;
  MapStore store{config, drive.T_base_lidar()};
  for (std::uint64_t id = 0; id < 50; ++id) store.add(drive.keyframe(id, box_begin_x, box_speed_mps));
  return count(store);
}

TEST(MovingPoints, AnOncomingCarLeavesNextToNothingAndTheStreetStays) {
  const Shares with_trail = drive(0, 60.0, -6.0);
  const Shares without = drive(24, 60.0, -6.0);
  EXPECT_GT(with_trail.box, 500U);
  EXPECT_LT(without.box, with_trail.box / 4);  // a fifth is left, by the compiler a point more or less
  EXPECT_GT(static_cast<double>(without.other), 0.995 * static_cast<double>(with_trail.other));
}

TEST(MovingPoints, ACarAheadLeavesNextToNothing) {
  const Shares with_trail = drive(0, 12.0, 8.0);
  EXPECT_GT(with_trail.box, 200U);
  EXPECT_LT(drive(24, 12.0, 8.0).box, with_trail.box / 5);
}

TEST(MovingPoints, AParkedCarStaysWhole) {
  const Shares all = drive(0, 25.0, 0.0);
  const Shares judged = drive(24, 25.0, 0.0);
  EXPECT_GT(all.box, 200U);
  EXPECT_GT(static_cast<double>(judged.box), 0.98 * static_cast<double>(all.box));
  EXPECT_GT(static_cast<double>(judged.other), 0.999 * static_cast<double>(all.other));
}

TEST(MovingPoints, TwoRunsGiveTheSameMap) {
  const Shares first = drive(24, 60.0, -6.0), second = drive(24, 60.0, -6.0);
  EXPECT_EQ(first.box, second.box);
  EXPECT_EQ(first.other, second.other);
}

}  // namespace
}  // namespace slamd
