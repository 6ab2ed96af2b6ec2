// Planar SLAM as a whole in a simulated room: accuracy, determinism, loops, the grid, and what happens without returns.

#include "estimator/grid/slam_2d.hpp"

#include <gtest/gtest.h>

#include "tests/estimator/planar_room.hpp"

namespace slamd {
namespace {

constexpr double kPeriod_s = 0.2;

HostTime at(int scan) { return HostTime{from_seconds(1.0 + scan * kPeriod_s)}; }

/// Round and round in the room's left part, 0.3 m/s.
PlanarPose circle(int scan) {
  const double angle = 0.3 * kPeriod_s * scan / 0.8;
  return {{-0.5 + 0.8 * std::sin(angle), 0.6 - 0.8 * std::cos(angle)}, angle};
}

struct Lap {
  double worst_m = 0.0;
  std::vector<PlanarPose> poses;
  OccupancyGrid grid;
};

/// wheel_bias  turn that the wheels tell too much, rad a scan
Lap run(int scans, double wheel_bias) {
  std::mt19937_64 rng{17};
  Slam2d slam{VehicleGeometry{}, Slam2dConfig{}};
  Lap result;
  PlanarPose wheels;
  for (int i = 0; i < scans; ++i) {
    if (i > 0) wheels = GroupSe2::plus(wheels * (circle(i - 1).inverse() * circle(i)), {0.0, 0.0, wheel_bias});
    slam.add(WheelOdometry{at(i), at(i), wheels.translation.x(), wheels.translation.y(), wheels.yaw_rad});
    const PlanarResult* found = slam.add(test::laser_scan(test::room(), circle(i), at(i), 0.01, rng));
    if (found == nullptr) continue;
    const Pose& T = found->state.T_odom_base;
    const PlanarPose truth = circle(0).inverse() * circle(i);
    result.worst_m = std::max(result.worst_m, (T.translation.head<2>() - truth.translation).norm());
    result.poses.push_back({T.translation.head<2>(), 2.0 * std::atan2(T.rotation.z(), T.rotation.w())});
    while (slam.work()) {
    }
  }
  slam.finish();
  result.grid = slam.grid();
  return result;
}

TEST(Slam2d, FollowsTheTruthAlthoughTheWheelsTurnTooFar) {
  const Lap result = run(120, 0.01);
  EXPECT_EQ(result.poses.size(), 120U);
  EXPECT_LT(result.worst_m, 0.03);
}

TEST(Slam2d, TwoRunsGiveTheSameBits) {
  const Lap a = run(60, 0.005);
  const Lap b = run(60, 0.005);
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].translation, b.poses[i].translation);
    EXPECT_EQ(a.poses[i].yaw_rad, b.poses[i].yaw_rad);
  }
  EXPECT_EQ(a.grid.cells, b.grid.cells);
}

TEST(Slam2d, TheGridHasWallsWhereTheyAreAndIsFreeBetween) {
  const Lap result = run(100, 0.0);
  const PlanarPose T_map_room = circle(0).inverse();
  const auto cell = [&](const Eigen::Vector2d& p_room) {
    const Eigen::Vector2d p = (T_map_room.rotation() * p_room + T_map_room.translation - result.grid.origin) / result.grid.resolution_m;
    return result.grid.cells[static_cast<std::size_t>(p.y()) * result.grid.width + static_cast<std::size_t>(p.x())];
  };
  EXPECT_EQ(cell({-2.0, 0.0}), kFreeCell);
  EXPECT_EQ(cell({0.5, 2.0}), kFreeCell);
  int occupied = 0;
  for (double x = 0.0; x < 4.0; x += 0.1) {
    const bool hit = cell({x, -2.0}) == kOccupiedCell || cell({x, -2.03}) == kOccupiedCell || cell({x, -1.97}) == kOccupiedCell;
    occupied += hit ? 1 : 0;
  }
  EXPECT_GT(occupied, 30);
}

TEST(Slam2d, AScanWithoutReturnsAndOneOutOfOrderAreCountedAndNotUsed) {
  std::mt19937_64 rng{1};
  Slam2d slam{VehicleGeometry{}, Slam2dConfig{}};
  ASSERT_NE(slam.add(test::laser_scan(test::room(), {}, at(1), 0.01, rng)), nullptr);
  EXPECT_EQ(slam.add(test::laser_scan(test::room(), {}, at(1), 0.01, rng)), nullptr);
  EXPECT_EQ(slam.add(test::laser_scan({}, {}, at(2), 0.01, rng)), nullptr);
  EXPECT_EQ(slam.odometry().stats().out_of_order, 1U);
  EXPECT_EQ(slam.odometry().stats().empty, 1U);
}

TEST(Slam2d, AnotherRoomIsNotBelieved) {
  std::mt19937_64 rng{1};
  Slam2d slam{VehicleGeometry{}, Slam2dConfig{}};
  for (int i = 0; i < 5; ++i) ASSERT_NE(slam.add(test::laser_scan(test::room(), {}, at(i), 0.01, rng)), nullptr);
  const std::vector<test::Wall> tube{{{-9, -0.3}, {9, -0.3}}, {{-9, 0.3}, {9, 0.3}}};
  const PlanarResult* found = slam.add(test::laser_scan(tube, {{}, 0.6}, at(5), 0.01, rng));
  ASSERT_NE(found, nullptr);
  EXPECT_NE(found->state.status, TrackingStatus::kTracking);
}

/// A square of four corners with wrong and right closures between its ends.
TEST(PlanarGraph, ARightClosureBendsTheDriveAndAWrongOneDoesNot) {
  PlanarNodes nodes;
  PlanarPose odom, truth;
  for (std::uint64_t i = 0; i <= 40; ++i) {
    PlanarNode node;
    node.id = i;
    node.way_m = static_cast<double>(i);
    node.T_odom_base = node.T_map_base = odom;
    node.relative_covariance = Eigen::Vector3d{1e-4, 1e-4, 1e-4}.asDiagonal();
    nodes.push_back(node);
    const Eigen::Vector3d step{1.0, 0.0, i % 10 == 9 ? M_PI / 2 : 0.0};
    odom = GroupSe2::plus(odom, step + Eigen::Vector3d{0.0, 0.0, 0.002});
    truth = GroupSe2::plus(truth, step);
  }
  const double before = nodes.back().T_map_base.translation.norm();
  const Eigen::Matrix3d sure = 1e-4 * Eigen::Matrix3d::Identity();
  std::vector<PlanarClosure> closures{{0, 40, PlanarPose{{0.0, 0.0}, 2.0 * M_PI}, sure, 1.0},
                                      {1, 39, PlanarPose{{-1.0, 1.0}, 1.5 * M_PI}, sure, 1.0},
                                      {5, 25, PlanarPose{{0.5, 0.5}, 0.0}, sure, 1.0}};
  solve_planar_graph(nodes, closures, PlanarGraphConfig{}, SolveLimits{});
  EXPECT_GT(before, 0.5);
  EXPECT_LT(nodes.back().T_map_base.translation.norm(), 0.05);
  EXPECT_GT(closures[0].weight, 0.8);
  EXPECT_LT(closures[2].weight, 0.01) << "ten metres off";
}

}  // namespace
}  // namespace slamd
