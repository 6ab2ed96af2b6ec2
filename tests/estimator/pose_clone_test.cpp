#include "estimator/filter/pose_clone.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "estimator/filter/imu_propagation.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Augmented = Eigen::Matrix<double, I::kSize + 6, I::kSize + 6>;

FilterSnapshot random_filter(Random& random) {
  FilterSnapshot filter;
  filter.state = test::random_state(random);
  filter.covariance = test::random_covariance(random, 0.05);
  return filter;
}

/// The whole covariance of state and clone, as a filter that carries both would have it.
Augmented augmented(const FilterSnapshot& filter) {
  Augmented p;
  p << filter.covariance, filter.clone.cross, filter.clone.cross.transpose(), filter.clone.covariance;
  return p;
}

ImuInterval random_interval(Random& random) {
  const Eigen::Vector3d gyro_rads = test::normal3(random, 1.5);
  return {from_seconds(0.005), gyro_rads, test::normal3(random, 8.0)};
}

TEST(PoseClone, ANewCloneSharesAllOfItsErrorWithTheState) {
  Random random{1};
  FilterSnapshot filter = random_filter(random);
  take_clone(filter);
  EXPECT_LT(motion_covariance(filter).norm(), 1e-15) << "from a pose to itself nothing is unknown";
}

TEST(PoseClone, CrossCovarianceMovesAsInAnAugmentedFilter) {
  Random random{2};
  FilterSnapshot filter = random_filter(random);
  take_clone(filter);
  Augmented p = augmented(filter);
  for (int i = 0; i < 50; ++i) {
    const ImuInterval interval = random_interval(random);
    const ErrorCovariance F = transition(filter.state, interval);
    Augmented F_augmented = Augmented::Identity();
    F_augmented.topLeftCorner<I::kSize, I::kSize>() = F;
    ErrorCovariance q = ErrorCovariance::Zero();
    propagate_covariance(F, ImuNoise{}, 0.005, q);
    p = (F_augmented * p * F_augmented.transpose()).eval();
    p.topLeftCorner<I::kSize, I::kSize>() += q;

    propagate_covariance(F, ImuNoise{}, 0.005, filter.covariance);
    propagate_cross(F, filter.clone.cross);
    filter.state = propagate(filter.state, interval);
  }
  EXPECT_LT((augmented(filter) - p).norm(), 1e-11 * p.norm());
}

Vector6d motion_error(const Pose& truth, const Pose& estimate) {
  const Pose error = estimate.inverse() * truth;
  Vector6d e;
  e << error.translation, log_so3(error.rotation);
  return e;
}

TEST(PoseClone, MotionCovarianceIsMappedByTheJacobianOfTheMotion) {
  Random random{3};
  for (int i = 0; i < 20; ++i) {
    FilterSnapshot filter = random_filter(random);
    take_clone(filter);
    filter.state = boxplus(filter.state, test::random_error(random, 0.5));
    const CloneCovariance change = 0.02 * CloneCovariance::Random();
    filter.clone.cross += change;
    InertialState clone;
    clone.R_odom_imu = filter.clone.T_odom_imu.rotation;
    clone.p_odom_imu = filter.clone.T_odom_imu.translation;
    const Pose estimate = filter.clone.T_odom_imu.inverse() * filter.state.T_odom_imu();
    const auto motion = [&](const Eigen::Matrix<double, 12, 1>& d) {
      ErrorVector of_state = ErrorVector::Zero();
      ErrorVector of_clone = ErrorVector::Zero();
      of_state.head<6>() = d.head<6>();
      of_clone.head<6>() = d.tail<6>();
      const Pose moved = boxplus(clone, of_clone).T_odom_imu().inverse() * boxplus(filter.state, of_state).T_odom_imu();
      return motion_error(moved, estimate);
    };
    const Eigen::Matrix<double, 6, 12> J = test::central_differences<6, 12>(motion);
    Eigen::Matrix<double, 12, 12> joint;
    joint << filter.covariance.topLeftCorner<6, 6>(), filter.clone.cross.topRows<6>(),
        filter.clone.cross.topRows<6>().transpose(), filter.clone.covariance;
    const Matrix6d expected = J * joint * J.transpose();
    EXPECT_LT((motion_covariance(filter) - expected).norm(), 1e-7 * expected.norm());
  }
}

/// Samples of the initial error and of the IMU's noise, carried by the state's own equations: no Jacobian takes part.
TEST(PoseClone, MotionCovarianceEqualsThatOfManyNoisyDrives) {
  Random random{4};
  FilterSnapshot filter = random_filter(random);
  filter.covariance = test::random_covariance(random, 0.003);
  take_clone(filter);
  const ErrorCovariance root = filter.covariance.llt().matrixL();
  constexpr int kRuns = 3'000, kSteps = 40;
  constexpr double kDt = 0.005;
  const ImuNoise noise{.gyro_noise_rads_rthz = 5e-3, .accel_noise_mps2_rthz = 5e-2};
  const ImuInterval interval = random_interval(random);
  std::vector<InertialState> drives(kRuns);
  for (InertialState& drive : drives) drive = boxplus(filter.state, root * test::random_error(random, 1.0));
  const std::vector<InertialState> begins = drives;
  for (int i = 0; i < kSteps; ++i) {
    const ErrorCovariance F = transition(filter.state, interval);
    propagate_covariance(F, noise, kDt, filter.covariance);
    propagate_cross(F, filter.clone.cross);
    filter.state = propagate(filter.state, interval);
    for (InertialState& drive : drives) {
      ImuInterval noisy = interval;
      noisy.gyro_rads += test::normal3(random, noise.gyro_noise_rads_rthz / std::sqrt(kDt));
      noisy.accel_mps2 += test::normal3(random, noise.accel_noise_mps2_rthz / std::sqrt(kDt));
      drive = propagate(drive, noisy);
    }
  }
  const Pose estimate = filter.clone.T_odom_imu.inverse() * filter.state.T_odom_imu();
  Matrix6d sampled = Matrix6d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const Pose truth = begins[run].T_odom_imu().inverse() * drives[run].T_odom_imu();
    const Vector6d e = motion_error(truth, estimate);
    sampled += e * e.transpose() / kRuns;
  }
  // Whitened by the claimed covariance the samples' is the identity, to the error of so many samples.
  const Matrix6d whiten = Matrix6d(motion_covariance(filter).llt().matrixL()).inverse();
  EXPECT_LT((whiten * sampled * whiten.transpose() - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 0.12);
}

}  // namespace
}  // namespace slamd
