// True motion of slam-sim: its derivatives are exact, and what the IMU feels integrates back to it.

#include <gtest/gtest.h>

#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

Trajectory make(const World& world, double slalom_m, const Wobble& wobble, bool moving) {
  const Path path{world.loop};
  TrajectoryPlan plan;
  plan.slalom_m = slalom_m;
  plan.wobble = wobble;
  plan.speed.legs = {{0.0, 150.0, 2.0}};
  plan.speed.rest_at_start_s = moving ? 0.0 : 2.0;
  plan.speed.speed_at_start_mps = moving ? 8.0 : 0.0;
  return Trajectory{world, path, plan};
}

const Wobble kRough{0.035, 0.045, 0.040, 0.015, 0.012, 0.10};

const World& campus() {
  static const World world = make_campus(1);
  return world;
}

TEST(SimMotion, VelocityAndAccelerationAreTheDerivativesOfThePose) {
  const Trajectory motion = make(campus(), 1.0, kRough, false);
  constexpr double kH = 1e-5;
  for (double t = 1.0; t < motion.duration() - 1.0; t += 0.377) {
    const Motion before = motion.at(t - kH), now = motion.at(t), after = motion.at(t + kH);
    const Vector3d velocity = (after.T_world_base.translation - before.T_world_base.translation) / (2 * kH);
    EXPECT_LT((now.velocity - velocity).norm(), 1e-6) << t;
    EXPECT_LT((now.acceleration - (after.velocity - before.velocity) / (2 * kH)).norm(), 1e-4) << t;
    const Eigen::AngleAxisd turn{before.T_world_base.rotation.conjugate() * after.T_world_base.rotation};
    EXPECT_LT((now.rate - turn.angle() * turn.axis() / (2 * kH)).norm(), 1e-5) << t;
    EXPECT_LT((now.rate_change - (after.rate - before.rate) / (2 * kH)).norm(), 1e-3) << t;
  }
}

/// Second-order integration of rates and specific force from the true start, at 2 kHz.
void expect_integrates(const Trajectory& motion, double seconds) {
  const Pose T_base_imu = reference_vehicle().T_base_imu;
  constexpr double kStep = 5e-4, kGravity = 9.80665;
  const Motion start = motion.at(0.0);
  Pose pose = start.T_world_base * T_base_imu;
  Vector3d velocity = start.velocity + start.T_world_base.rotation * start.rate.cross(T_base_imu.translation);
  const auto count = static_cast<int>(seconds / kStep);
  for (int i = 0; i < count; ++i) {
    const Inertial felt = inertial_at(motion.at((i + 0.5) * kStep), T_base_imu, kGravity);
    const auto turned = [&](double dt) {
      const Vector3d angle = felt.rate_rads * dt;
      return angle.norm() > 0.0 ? Eigen::Quaterniond{Eigen::AngleAxisd(angle.norm(), angle.normalized())}
                                : Eigen::Quaterniond::Identity();
    };
    const Eigen::Quaterniond middle = pose.rotation * turned(0.5 * kStep);
    const Vector3d acceleration = middle * felt.specific_force_mps2 - kGravity * Vector3d::UnitZ();
    pose.translation += velocity * kStep + 0.5 * acceleration * kStep * kStep;
    velocity += acceleration * kStep;
    pose.rotation = (pose.rotation * turned(kStep)).normalized();
  }
  const Pose truth = motion.pose_at(count * kStep) * T_base_imu;
  EXPECT_LT((pose.translation - truth.translation).norm(), 2e-3);
  EXPECT_LT(pose.rotation.angularDistance(truth.rotation), 1e-5);
}

TEST(SimMotion, WhatTheImuFeelsIntegratesToTheTruth) {
  expect_integrates(make(campus(), 0.0, Wobble{}, false), 18.0);
}
TEST(SimMotion, RoughMotionIntegratesToTheTruthToo) {
  expect_integrates(make(campus(), 1.0, kRough, false), 18.0);
}
TEST(SimMotion, AMovingStartIntegratesToTheTruthToo) {
  expect_integrates(make(campus(), 0.0, Wobble{}, true), 10.0);
}

TEST(SimMotion, StandsPerfectlyStillBeforeItStarts) {
  const Trajectory motion = make(campus(), 0.0, Wobble{}, false);
  for (double t = 0.0; t < 1.95; t += 0.05) {
    EXPECT_LT(motion.at(t).velocity.norm(), 1e-9);
    EXPECT_LT(motion.at(t).rate.norm(), 1e-9);
  }
  const Inertial rest = inertial_at(motion.at(1.0), reference_vehicle().T_base_imu, 9.80665);
  EXPECT_NEAR(rest.specific_force_mps2.norm(), 9.80665, 1e-9);
}

TEST(SimMotion, AMovingStartMovesFromTheFirstInstantWithoutAJerk) {
  const Trajectory motion = make(campus(), 0.0, Wobble{}, true);
  EXPECT_GT(motion.at(0.0).velocity.norm(), 5.0);
  for (double t = 0.0; t < 2.0; t += 0.01) EXPECT_LT(motion.at(t).acceleration.norm(), 6.0) << t;
}

TEST(SimMotion, KeepsTheLimitsOfSpeedAndAccelerationAndDrivesNoseFirst) {
  const World& world = campus();
  const Path path{world.loop};
  TrajectoryPlan plan;
  plan.wobble = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  plan.speed.legs = {{0.0, path.length(), 2.0}};
  const Trajectory motion{world, path, plan};
  EXPECT_NEAR(motion.distance_at(motion.duration()), path.length(), 0.05);
  for (double t = 0.0; t < motion.duration(); t += 0.1) {
    const Motion now = motion.at(t);
    EXPECT_LT(now.velocity.norm(), 8.1);
    EXPECT_LT(now.acceleration.head<2>().norm(), 3.8) << t;  // braking into a bend uses both limits
    const Vector3d in_base = now.T_world_base.rotation.conjugate() * now.velocity;
    EXPECT_LT(std::abs(in_base.y()), 0.02 * std::max(1.0, in_base.x())) << t;
    EXPECT_GT(in_base.x(), -1e-3);
  }
}

TEST(SimMotion, APathIsParameterisedByItsLength) {
  const Path path{campus().loop, 2};
  EXPECT_GT(path.length(), 1700.0);
  for (double s = 5.0; s < path.length() - 5.0; s += 3.7) {
    const auto before = path.at(s - 0.01), after = path.at(s + 0.01);
    ASSERT_NEAR((after.position - before.position).norm(), 0.02, 5e-5) << s;
    ASSERT_NEAR(std::remainder(after.yaw - before.yaw, 6.283185307179586), 0.02 * path.at(s).curvature_per_m, 1e-4)
        << s;
  }
}

}  // namespace
}  // namespace slamd::sim
