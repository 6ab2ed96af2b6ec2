#include "estimator/filter/point_to_plane.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/plane_rooms.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

const Eigen::Vector3d kHalf{6.0, 5.0, 3.0};

class PointToPlaneInARoom : public ::testing::Test {
 protected:
  PointToPlaneInARoom() {
    config_.max_voxels = 20'000;
    map_ = std::make_unique<PlaneMap>(config_);
    test::fill_map(*map_, walls_, random_, 0.005);
    state_.T_imu_lidar = Pose{exp_so3({0.1, -0.2, 0.7}), {0.3, -0.1, 0.2}};
    state_.R_odom_imu = exp_so3({0.2, 0.1, -1.0});
    state_.p_odom_imu = {0.5, -0.4, 0.3};
  }

  /// The linearisation of one point alone: gradient / sqrt(w) and information tell h and r.
  Linearisation of_one(const MeasuredPoint& point, const InertialState& at, bool with_extrinsic = true) {
    PointToPlane residuals{wide_, 10};
    residuals.associate({&point, 1}, state_, *map_);
    return residuals.linearise(at, Matrix6d::Zero(), with_extrinsic);
  }

  static PointToPlaneConfig wide() {
    PointToPlaneConfig config;
    config.gate_sigmas = 1e3;
    config.max_residual_m = 100.0;
    config.robust_scale = 1e6;
    return config;
  }

  Random random_{1};
  PlaneMapConfig config_;
  std::vector<test::Wall> walls_ = test::room(kHalf);
  std::unique_ptr<PlaneMap> map_;
  InertialState state_;
  PointToPlaneConfig wide_ = wide();
};

TEST_F(PointToPlaneInARoom, EachRowOfTheJacobianEqualsFiniteDifferences) {
  int compared = 0;
  for (const MeasuredPoint& point : test::see(walls_, state_, random_, 60, 0.02)) {
    const Linearisation at = of_one(point, state_);
    if (at.inliers != 1) continue;
    const PointToPlaneConfig& config = wide_;
    PointToPlane residuals{config, 10};
    residuals.associate({&point, 1}, state_, *map_);
    // With one point and no robust weight: squared_error = r^2 / variance, information = h h^T / variance.
    const auto squared_residual = [&](const ErrorVector& d) {
      const double e = residuals.linearise(boxplus(state_, d), Matrix6d::Zero(), true).squared_error;
      return Eigen::Matrix<double, 1, 1>{e};
    };
    const auto numeric = test::central_differences<1, I::kSize>(squared_residual, 1e-6);
    // d(r^2 / v) = 2 r h / v but for the small change of the variance, which fades with the residual.
    const MeasuredVector analytic = 2.0 * at.gradient;
    const double scale = std::max(1.0, analytic.norm());
    EXPECT_LT((numeric.transpose().head(I::kMeasured) - analytic).norm(), 0.08 * scale);
    EXPECT_LT(numeric.tail(I::kSize - I::kMeasured).norm(), 1e-6 * scale);
    ++compared;
  }
  EXPECT_GT(compared, 40);
}

TEST_F(PointToPlaneInARoom, TheGradientIsThatOfTheGeometry) {
  for (const MeasuredPoint& point : test::see(walls_, state_, random_, 60, 0.02)) {
    const Eigen::Vector3d p_lidar = point.p_lidar.cast<double>();
    const Plane* plane = map_->plane_at((state_.T_odom_lidar() * p_lidar).cast<float>());
    if (plane == nullptr) continue;
    const Eigen::Vector3d normal = plane->normal.cast<double>(), centre = plane->centre.cast<double>();
    const auto residual = [&](const ErrorVector& d) {
      return Eigen::Matrix<double, 1, 1>{normal.dot(boxplus(state_, d).T_odom_lidar() * p_lidar - centre)};
    };
    const Eigen::Matrix<double, 1, I::kSize> h = test::central_differences<1, I::kSize>(residual);
    const Linearisation at = of_one(point, state_);
    const MeasuredVector h_measured = h.head<I::kMeasured>().transpose();
    // Less what noise in the normal fakes on average, towards both axes of the plane.
    const double r = residual(ErrorVector::Zero())(0);
    MeasuredMatrix information = h_measured * h_measured.transpose();
    MeasuredVector gradient = r * h_measured;
    for (const Plane::Tilt& tilt : plane->tilts()) {
      const Eigen::Vector3d towards = tilt.towards.cast<double>();
      const auto along = [&](const ErrorVector& d) {
        return Eigen::Matrix<double, 1, 1>{towards.dot(boxplus(state_, d).T_odom_lidar() * p_lidar - centre)};
      };
      const MeasuredVector h_tilt =
          test::central_differences<1, I::kSize>(along).head<I::kMeasured>().transpose();
      information -= double{tilt.variance} * h_tilt * h_tilt.transpose();
      gradient -= tilt.variance * along(ErrorVector::Zero())(0) * h_tilt;
    }
    const double weight = at.information.trace() / information.trace();
    EXPECT_LT((at.information - weight * information).norm(), 1e-5 * at.information.norm());
    EXPECT_LT((at.gradient - weight * gradient).norm(), 1e-5 * weight * std::max(0.01, std::abs(r)));
  }
}

TEST_F(PointToPlaneInARoom, PointsBeyondTheGateTellNothingButCountAsContradiction) {
  const auto points = test::see(walls_, state_, random_, 200, 0.02);
  PointToPlane residuals{PointToPlaneConfig{}, 1'000};
  residuals.associate(points, state_, *map_);
  ErrorVector off = ErrorVector::Zero();
  off.segment<3>(I::kPosition).setConstant(0.4);
  const Linearisation there = residuals.linearise(state_, Matrix6d::Zero(), false);
  const Linearisation beside = residuals.linearise(boxplus(state_, off), Matrix6d::Zero(), false);
  ASSERT_EQ(beside.matched, there.matched);
  EXPECT_LT(beside.inliers, there.inliers / 10);
  const double gate2 = PointToPlaneConfig{}.gate_sigmas * PointToPlaneConfig{}.gate_sigmas;
  EXPECT_GT(beside.squared_error, 0.9 * gate2 * beside.matched);
  EXPECT_LE(beside.squared_error, 1.001 * gate2 * beside.matched);
}

TEST_F(PointToPlaneInARoom, WithoutTheExtrinsicItsRowsAreZero) {
  const auto points = test::see(walls_, state_, random_, 200, 0.02);
  PointToPlane residuals{PointToPlaneConfig{}, 1'000};
  residuals.associate(points, state_, *map_);
  const Linearisation at = residuals.linearise(state_, Matrix6d::Zero(), false);
  EXPECT_GT(at.inliers, 100U);
  EXPECT_EQ(at.information.bottomRows(6).norm(), 0.0);
  EXPECT_EQ(at.gradient.tail(6).norm(), 0.0);
  EXPECT_LT((at.information - at.information.transpose()).norm(), 1e-12 * at.information.norm());
}

TEST_F(PointToPlaneInARoom, PointsBeyondTheGateAreMatchedButNotUsed) {
  auto points = test::see(walls_, state_, random_, 300, 0.005);
  InertialState shifted = state_;
  shifted.p_odom_imu += Eigen::Vector3d{0.4, 0.4, 0.4};
  PointToPlane residuals{PointToPlaneConfig{}, 1'000};
  residuals.associate(points, shifted, *map_);
  const Linearisation sure = residuals.linearise(shifted, Matrix6d::Zero(), false);
  EXPECT_GT(sure.matched, 200U);
  EXPECT_LT(sure.inliers, sure.matched / 10);
  Matrix6d unsure = Matrix6d::Zero();
  unsure.diagonal().segment<3>(I::kPosition).setConstant(0.25);
  const Linearisation open = residuals.linearise(shifted, unsure, false);
  EXPECT_GT(open.inliers, open.matched * 9 / 10) << "an uncertain prior opens the gate";
}

TEST_F(PointToPlaneInARoom, AnOutlierInsideTheGateWeighsLess) {
  PointToPlaneConfig robust;
  robust.gate_sigmas = 1e3;
  robust.max_residual_m = 100.0;
  const auto points = test::see(walls_, state_, random_, 300, 0.0);
  const auto information_at = [&](double offset_m) {
    InertialState moved = state_;
    moved.p_odom_imu += Eigen::Vector3d::Constant(offset_m);
    PointToPlane residuals{robust, 1'000};
    residuals.associate(points, state_, *map_);
    return residuals.linearise(moved, Matrix6d::Zero(), false).information.trace();
  };
  EXPECT_LT(information_at(0.2), 0.3 * information_at(0.0));
}

TEST_F(PointToPlaneInARoom, MoreReturnsNeverWeighLess) {
  for (MeasuredPoint point : test::see(walls_, state_, random_, 20, 0.0)) {
    const double one = of_one(point, state_).information.trace();
    point.returns = 8.0F;
    EXPECT_GE(of_one(point, state_).information.trace(), one);
  }
}

TEST(PointToPlane, APlaneThatNoBeamCanComeBackFromIsNotMatched) {
  PlaneMapConfig map_config;
  map_config.max_voxels = 20'000;
  PlaneMap map{map_config};
  std::vector<Eigen::Vector3f> floor;
  for (float x = 8.0F; x < 12.0F; x += 0.1F) {
    for (float y = -2.0F; y < 2.0F; y += 0.1F) floor.push_back({x, y, 0.0F});
  }
  for (const Eigen::Vector3f& p : floor) map.insert(p);
  const auto matched_from = [&](double x, double height_m) {
    InertialState state;
    state.p_odom_imu = {x, 0.0, height_m};
    std::vector<MeasuredPoint> points;
    for (const Eigen::Vector3f& p : floor) points.push_back({p - state.p_odom_imu.cast<float>()});
    PointToPlane residuals{PointToPlaneConfig{}, floor.size()};
    residuals.associate(points, state, map);
    return residuals.linearise(state, Matrix6d::Zero(), false).matched;
  };
  EXPECT_EQ(matched_from(0.0, 1.9), floor.size());
  EXPECT_EQ(matched_from(0.0, 0.3), 0U) << "through the sensor";
  EXPECT_EQ(matched_from(0.0, -0.3), 0U);
  EXPECT_EQ(matched_from(-60.0, 1.9), 0U) << "grazed";
}

TEST_F(PointToPlaneInARoom, PointsThatAreNotFiniteAreNotMatched) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const std::vector<MeasuredPoint> points{{{kNan, 0, 0}, 1.0F}, {{0, kInf, 0}, 1.0F}, {{1e30F, 0, 0}, 1.0F}};
  PointToPlane residuals{PointToPlaneConfig{}, 10};
  residuals.associate(points, state_, *map_);
  const Linearisation at = residuals.linearise(state_, Matrix6d::Zero(), true);
  EXPECT_EQ(at.matched, 0U);
  EXPECT_TRUE(at.information.allFinite());
}

TEST_F(PointToPlaneInARoom, AnEmptyMapMatchesNothing) {
  map_->clear();
  const auto points = test::see(walls_, state_, random_, 50, 0.0);
  PointToPlane residuals{PointToPlaneConfig{}, 100};
  residuals.associate(points, state_, *map_);
  EXPECT_EQ(residuals.linearise(state_, Matrix6d::Zero(), true).matched, 0U);
}

TEST_F(PointToPlaneInARoom, MorePointsThanItsCapacityAreCutOff) {
  const auto points = test::see(walls_, state_, random_, 500, 0.0);
  PointToPlane residuals{PointToPlaneConfig{}, 100};
  residuals.associate(points, state_, *map_);
  EXPECT_EQ(residuals.linearise(state_, Matrix6d::Zero(), false).matched, 100U);
}

}  // namespace
}  // namespace slamd
