#include "estimator/lidar/deskew.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

/// A strong motion with all axes turning and accelerating.
Pose T_odom_imu_at(double t) {
  const Eigen::Quaterniond rotation = exp_so3({0.3 * std::sin(6.0 * t), 0.2 * std::cos(5.0 * t), 3.0 * t});
  return {rotation, {15.0 * t + 2.0 * t * t, std::sin(4.0 * t), 0.1 * std::cos(9.0 * t)}};
}

const Pose kExtrinsic{exp_so3({0.1, -0.2, 0.4}), {0.3, 0.1, 0.4}};
constexpr double kScan_s = 0.1;

ScanMotion motion_with_knots(int knots) {
  ScanMotion motion{64};
  for (int i = 0; i < knots; ++i) {
    const double t = kScan_s * i / (knots - 1);
    motion.add(t, T_odom_imu_at(t));
  }
  motion.finish(kExtrinsic);
  return motion;
}

Eigen::Vector3d exact(const Eigen::Vector3d& p_lidar, double t) {
  const Pose T_odom_end = T_odom_imu_at(kScan_s) * kExtrinsic;
  return T_odom_end.inverse() * ((T_odom_imu_at(t) * kExtrinsic) * p_lidar);
}

double worst_error(int knots) {
  const ScanMotion motion = motion_with_knots(knots);
  Random random{1};
  double worst = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p = 30.0 * test::unit3(random);
    const double t = test::uniform(random, 0.0, kScan_s);
    const Eigen::Vector3f moved = motion.deskew(p.cast<float>(), static_cast<float>(t));
    worst = std::max(worst, (moved.cast<double>() - exact(p, t)).norm());
  }
  return worst;
}

TEST(Deskew, StrongMotionAt200HzIsUndoneToAMillimetre) { EXPECT_LT(worst_error(21), 1.5e-3); }

TEST(Deskew, DenserKnotsAreMoreExact) { EXPECT_LT(worst_error(41), 0.5 * worst_error(11)); }

TEST(Deskew, PointsAtTheKnotsAreExact) {
  const ScanMotion motion = motion_with_knots(21);
  Random random{2};
  for (int i = 0; i < 21; ++i) {
    const double t = kScan_s * i / 20;
    const Eigen::Vector3d p = 20.0 * test::unit3(random);
    EXPECT_LT((motion.deskew(p.cast<float>(), static_cast<float>(t)).cast<double>() - exact(p, t)).norm(), 2e-5);
  }
}

TEST(Deskew, APointOfTheScansEndStaysWhereItIs) {
  const ScanMotion motion = motion_with_knots(21);
  const Eigen::Vector3f p{10.0F, -5.0F, 2.0F};
  EXPECT_LT((motion.deskew(p, static_cast<float>(kScan_s)) - p).norm(), 1e-5);
  EXPECT_LT((motion.deskew(p, static_cast<float>(kScan_s) + 0.01F) - p).norm(), 1e-5) << "beyond the end: held";
}

TEST(Deskew, ALittleBeforeTheFirstKnotTheMotionIsContinuedBackwards) {
  ScanMotion motion{64};
  for (int i = 1; i < 21; ++i) motion.add(kScan_s * i / 20, T_odom_imu_at(kScan_s * i / 20));
  motion.finish(kExtrinsic);
  const Eigen::Vector3d p{10.0, -5.0, 2.0};
  EXPECT_LT((motion.deskew(p.cast<float>(), 0.002F).cast<double>() - exact(p, 0.002)).norm(), 5e-3);
}

TEST(Deskew, WithoutMotionPointsStay) {
  ScanMotion none{4};
  none.finish(kExtrinsic);
  const Eigen::Vector3f p{10.0F, -5.0F, 2.0F};
  EXPECT_EQ(none.deskew(p, 0.05F), p);
  ScanMotion one{4};
  one.add(0.1, T_odom_imu_at(0.1));
  one.finish(kExtrinsic);
  EXPECT_LT((one.deskew(p, 0.05F) - p).norm(), 1e-5);
}

TEST(Deskew, TwoKnotsOfTheSameTimeAreHarmless) {
  ScanMotion motion{8};
  motion.add(0.0, T_odom_imu_at(0.0));
  motion.add(0.0, T_odom_imu_at(0.0));
  motion.add(0.1, T_odom_imu_at(0.1));
  motion.finish(kExtrinsic);
  EXPECT_TRUE(motion.deskew({1.0F, 2.0F, 3.0F}, 0.0F).allFinite());
  EXPECT_TRUE(motion.deskew({1.0F, 2.0F, 3.0F}, 0.05F).allFinite());
}

TEST(Deskew, ClearStartsAnew) {
  ScanMotion motion = motion_with_knots(21);
  motion.clear();
  motion.add(0.0, Pose{});
  motion.add(0.1, Pose{});
  motion.finish(kExtrinsic);
  const Eigen::Vector3f p{4.0F, 5.0F, 6.0F};
  EXPECT_LT((motion.deskew(p, 0.03F) - p).norm(), 1e-5);
}

}  // namespace
}  // namespace slamd
