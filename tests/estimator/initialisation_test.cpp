#include "estimator/filter/initialisation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using I = ErrorIndex;
using test::Random;

const Pose kBaseImu{exp_so3({0.03, -0.02, 1.5}), {0.12, -0.08, 1.52}};
const Pose kImuLidar{exp_so3({0.0, 0.2, -1.5}), {0.3, 0.1, 0.3}};

struct RestingImu {
  Eigen::Quaterniond R_odom_imu = kBaseImu.rotation;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  double gyro_sigma = 0.002;
  double accel_sigma = 0.02;

  ImuSample sample(int i, Random& random) const {
    ImuSample out{.time = from_ns<HostTime>(5'000'000LL * i), .arrival = from_ns<HostTime>(5'000'000LL * i)};
    out.gyro_rads = gyro_bias + test::normal3(random, gyro_sigma);
    out.accel_mps2 = R_odom_imu.conjugate() * Eigen::Vector3d{0, 0, kGravity_mps2} + accel_bias +
                     test::normal3(random, accel_sigma);
    return out;
  }
};

void feed(Initialisation& initialisation, const RestingImu& imu, int samples, Random& random) {
  for (int i = 0; i < samples; ++i) initialisation.add(imu.sample(i, random));
}

InitialState state_of(const Initialisation& initialisation, bool with_extrinsic = false) {
  return initialisation.state(from_ns<HostTime>(1'000'000'000), kBaseImu, kImuLidar, with_extrinsic);
}

void expect_covariance(const ErrorCovariance& p) {
  EXPECT_TRUE(p.allFinite());
  EXPECT_LT((p - p.transpose()).norm(), 1e-15);
  const Eigen::SelfAdjointEigenSolver<ErrorCovariance> solver(p);
  EXPECT_GE(solver.eigenvalues().minCoeff(), -1e-12);
}

TEST(Initialisation, NothingIsReadyBeforeSamples) {
  const Initialisation initialisation{InitialisationConfig{}};
  EXPECT_FALSE(initialisation.is_ready());
  EXPECT_FALSE(initialisation.is_still());
}

TEST(Initialisation, RestIsBelievedOnlyAfterItHasLasted) {
  Random random{1};
  const InitialisationConfig config;
  Initialisation initialisation{config};
  const RestingImu imu;
  const int needed = static_cast<int>(config.rest_s / 0.005);
  feed(initialisation, imu, needed - 2, random);
  EXPECT_FALSE(initialisation.is_ready());
  feed(initialisation, imu, needed + 2, random);
  EXPECT_TRUE(initialisation.is_ready());
  EXPECT_TRUE(initialisation.is_still());
}

TEST(Initialisation, AtRestTheTiltAndTheGyroBiasAreFound) {
  Random random{2};
  for (int run = 0; run < 20; ++run) {
    Initialisation initialisation{InitialisationConfig{}};
    RestingImu imu;
    const Eigen::Quaterniond R_odom_base = exp_so3({test::normal(random, 0.1), test::normal(random, 0.1), 0.0});
    imu.R_odom_imu = R_odom_base * kBaseImu.rotation;
    imu.gyro_bias = test::normal3(random, 0.01);
    feed(initialisation, imu, 200, random);
    const InitialState initial = state_of(initialisation);
    ASSERT_TRUE(initial.at_rest);
    const InertialState& state = initial.filter.state;
    const Eigen::Vector3d up_imu = state.R_odom_imu.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((up_imu - imu.R_odom_imu.conjugate() * Eigen::Vector3d::UnitZ()).norm(), 0.002);
    EXPECT_LT((state.gyro_bias - imu.gyro_bias).norm(), 0.001);
    EXPECT_EQ(state.v_odom_imu, Eigen::Vector3d::Zero());
    EXPECT_EQ(initial.filter.time, from_ns<HostTime>(1'000'000'000));
    expect_covariance(initial.filter.covariance);
  }
}

TEST(Initialisation, ABiasThatIsKnownAlreadyDoesNotTiltTheStart) {
  Random random{3};
  RestingImu imu;
  imu.accel_bias = {0.12, -0.10, 0.05};
  InitialisationConfig config;
  config.known_accel_bias_mps2 = imu.accel_bias;
  const auto tilt_rad = [&](const InitialisationConfig& with) {
    Initialisation initialisation{with};
    feed(initialisation, imu, 200, random);
    const InertialState state = state_of(initialisation).filter.state;
    return (state.R_odom_imu * imu.R_odom_imu.conjugate() * Eigen::Vector3d::UnitZ()).head<2>().norm();
  };
  EXPECT_GT(tilt_rad(InitialisationConfig{}), 0.01);
  EXPECT_LT(tilt_rad(config), 0.001);
  Initialisation known{config};
  feed(known, imu, 200, random);
  EXPECT_LT((state_of(known).filter.state.accel_bias - imu.accel_bias).norm(), 0.005);
}

TEST(Initialisation, AMotionSeenAMomentAgoGoesOnAndOneOfLongAgoDoesNot) {
  Random random{7};
  RestingImu imu;
  imu.accel_sigma = 1.0;  // a vehicle that moves
  const Eigen::Vector3d velocity_mps{7.5, 0.1, 0.2};
  const Eigen::Vector3d up = exp_so3({0.04, -0.08, 0.0}) * Eigen::Vector3d::UnitZ();
  const auto start = [&](double seen_at_s) {
    InitialisationConfig config;
    config.known_motion = {seen_at_s, velocity_mps, up};
    Initialisation initialisation{config};
    feed(initialisation, imu, 100, random);
    return state_of(initialisation);
  };
  const InitialState soon = start(0.4);  // the state is asked for at 1 s
  ASSERT_FALSE(soon.at_rest);
  EXPECT_TRUE(soon.motion_known);
  const InertialState& state = soon.filter.state;
  const Eigen::Quaterniond R_odom_base = state.R_odom_imu * kBaseImu.rotation.conjugate();
  EXPECT_LT((R_odom_base.conjugate() * state.v_odom_imu - velocity_mps).norm(), 1e-9);
  EXPECT_LT((R_odom_base.conjugate() * Eigen::Vector3d::UnitZ() - up).norm(), 1e-9);
  expect_covariance(soon.filter.covariance);
  const auto velocity_sigma_mps = [](const InitialState& of) {
    return std::sqrt(of.filter.covariance(ErrorIndex::kVelocity, ErrorIndex::kVelocity));
  };
  EXPECT_LT(velocity_sigma_mps(soon), 2.5);
  for (const double seen_at_s : {0.0, -5.0, 1.5}) {  // not known, long ago, not yet
    const InitialState anew = start(seen_at_s);
    EXPECT_FALSE(anew.motion_known);
    EXPECT_EQ(anew.filter.state.v_odom_imu, Eigen::Vector3d::Zero());
    EXPECT_GT(velocity_sigma_mps(anew), 5.0);
  }
}

TEST(Initialisation, BaseStandsAtTheOriginOfOdomLookingAlongX) {
  Random random{3};
  Initialisation initialisation{InitialisationConfig{}};
  RestingImu imu;
  imu.R_odom_imu = exp_so3({0.1, -0.05, 0.0}) * kBaseImu.rotation;
  feed(initialisation, imu, 200, random);
  const InertialState state = state_of(initialisation).filter.state;
  const Pose T_odom_base = state.T_odom_imu() * kBaseImu.inverse();
  EXPECT_LT(T_odom_base.translation.norm(), 1e-12);
  EXPECT_NEAR((T_odom_base.rotation * Eigen::Vector3d::UnitX()).y(), 0.0, 1e-12);
  EXPECT_GT((T_odom_base.rotation * Eigen::Vector3d::UnitX()).x(), 0.9);
  EXPECT_LT((state.T_imu_lidar.translation - kImuLidar.translation).norm(), 1e-15);
}

TEST(Initialisation, AStateAtRestStaysAtRestUnderItsOwnSamples) {
  Random random{4};
  Initialisation initialisation{InitialisationConfig{}};
  RestingImu imu;
  imu.accel_bias = {0.05, -0.1, 0.08};
  imu.gyro_sigma = imu.accel_sigma = 0.0;
  feed(initialisation, imu, 200, random);
  const InertialState state = state_of(initialisation).filter.state;
  const Eigen::Vector3d force = imu.sample(0, random).accel_mps2 - state.accel_bias;
  EXPECT_LT((state.R_odom_imu * force + state.gravity).norm(), 1e-9);
}

TEST(Initialisation, MovingIsReadySoonerAndLessSure) {
  Random random{5};
  const InitialisationConfig config;
  Initialisation moving{config}, resting{config};
  RestingImu shaken;
  shaken.gyro_sigma = 0.3;
  shaken.accel_sigma = 1.5;
  feed(moving, shaken, static_cast<int>(config.min_s / 0.005) + 2, random);
  feed(resting, RestingImu{}, 200, random);
  ASSERT_TRUE(moving.is_ready());
  EXPECT_FALSE(moving.is_still());
  const InitialState a = state_of(moving), b = state_of(resting);
  EXPECT_FALSE(a.at_rest);
  EXPECT_EQ(a.filter.state.gyro_bias, Eigen::Vector3d::Zero()) << "a turn is no bias";
  for (const int row : {I::kVelocity, I::kGyroBias, I::kGravity})
    EXPECT_GT(a.filter.covariance(row, row), b.filter.covariance(row, row)) << "row " << row;
  expect_covariance(a.filter.covariance);
}

/// Many vehicles with the biases that the config believes in: the errors of gravity and accelerometer bias in the filter's
/// own frame (whose attitude is right by definition) have the covariance that the filter is told.
TEST(Initialisation, GravityAndAccelerometerBiasAreCorrelatedAsTheSamplesSay) {
  Random random{6};
  const InitialisationConfig config;
  constexpr int kRuns = 2'000;
  Eigen::Matrix<double, 5, 5> sampled = Eigen::Matrix<double, 5, 5>::Zero(), told = sampled;
  for (int run = 0; run < kRuns; ++run) {
    Initialisation initialisation{config};
    RestingImu imu;
    imu.accel_bias = test::normal3(random, config.accel_bias_mps2);
    imu.accel_bias.z() = 0.0;  // what lies along gravity is seen in its magnitude, and known better than told
    feed(initialisation, imu, 165, random);
    const FilterSnapshot filter = state_of(initialisation).filter;
    // The filter's attitude defines odom, so the truth is turned into that odom.
    const Eigen::Vector3d true_gravity =
        filter.state.R_odom_imu * (imu.R_odom_imu.conjugate() * Eigen::Vector3d{0, 0, -kGravity_mps2});
    Eigen::Matrix<double, 5, 1> error;
    error << imu.accel_bias - filter.state.accel_bias, boxminus_s2(true_gravity, filter.state.gravity);
    sampled += error * error.transpose() / kRuns;
    told += filter.covariance.bottomRightCorner<5, 5>() / kRuns;
  }
  const double gravity_sigma = config.accel_bias_mps2 / kGravity_mps2;
  EXPECT_LT((sampled - told).bottomRightCorner(2, 2).cwiseAbs().maxCoeff(), 0.2 * gravity_sigma * gravity_sigma);
  EXPECT_LT((sampled - told).block(0, 3, 2, 2).cwiseAbs().maxCoeff(), 0.2 * config.accel_bias_mps2 * gravity_sigma);
  EXPECT_LT((sampled - told).topLeftCorner(2, 2).cwiseAbs().maxCoeff(), 0.2 * std::pow(config.accel_bias_mps2, 2));
}

TEST(Initialisation, ExtrinsicIsUncertainOnlyWhenItIsEstimated) {
  Random random{7};
  Initialisation initialisation{InitialisationConfig{}};
  feed(initialisation, RestingImu{}, 200, random);
  const ErrorCovariance fixed = state_of(initialisation, false).filter.covariance;
  const ErrorCovariance free = state_of(initialisation, true).filter.covariance;
  EXPECT_EQ(fixed.middleRows(I::kExtrinsicRotation, 6).norm(), 0.0);
  for (int i = 0; i < 6; ++i) EXPECT_GT(free(I::kExtrinsicRotation + i, I::kExtrinsicRotation + i), 0.0);
}

TEST(Initialisation, ABumpLongBeforeDoesNotMatter) {
  Random random{9};
  const InitialisationConfig config;
  Initialisation initialisation{config};
  RestingImu imu;
  imu.gyro_bias = {0.01, -0.004, 0.006};
  const auto add = [&](int i, const Eigen::Vector3d& bump) {
    ImuSample sample = imu.sample(i, random);
    sample.accel_mps2 += bump;
    sample.gyro_rads += 0.1 * bump;
    initialisation.add(sample);
  };
  int i = 0;
  for (; i < 100; ++i) add(i, Eigen::Vector3d::Zero());
  for (; i < 120; ++i) add(i, {3.0, i % 2 == 0 ? 5.0 : -5.0, 1.0});
  EXPECT_FALSE(initialisation.is_still());
  EXPECT_TRUE(initialisation.is_ready()) << "moving, for all that is known";
  const int still_since = i;
  for (; i < still_since + static_cast<int>(config.rest_s / 0.005) - 5; ++i) add(i, Eigen::Vector3d::Zero());
  EXPECT_FALSE(initialisation.is_still());
  for (; i < still_since + static_cast<int>(config.rest_s / 0.005) + 5; ++i) add(i, Eigen::Vector3d::Zero());
  EXPECT_TRUE(initialisation.is_still());
  const InitialState initial = state_of(initialisation);
  EXPECT_TRUE(initial.at_rest);
  EXPECT_LT((initial.filter.state.gyro_bias - imu.gyro_bias).norm(), 0.001);
}

TEST(Initialisation, ForHoursAtRestItStaysAsSureAsAfterTheFirstWindow) {
  Random random{10};
  Initialisation initialisation{InitialisationConfig{}};
  RestingImu imu;
  for (int i = 0; i < 200'000; ++i) {
    imu.gyro_bias.x() = 0.01 * i / 200'000.0;  // warming up: the mean since power-on would be half of it
    initialisation.add(imu.sample(i, random));
  }
  ASSERT_TRUE(initialisation.is_still());
  EXPECT_NEAR(state_of(initialisation).filter.state.gyro_bias.x(), 0.01, 0.0006);
}

TEST(Initialisation, AVeryFastImuIsReadyWhenTheWindowIsFull) {
  Random random{11};
  Initialisation initialisation{InitialisationConfig{}};
  const RestingImu imu;
  int needed = 0;
  for (; needed < 10'000 && !initialisation.is_ready(); ++needed) {
    ImuSample sample = imu.sample(needed, random);
    sample.time = from_ns<HostTime>(100'000LL * needed);  // 10 kHz
    initialisation.add(sample);
  }
  EXPECT_EQ(needed, 1'024);
  EXPECT_TRUE(state_of(initialisation).at_rest);
}

TEST(Initialisation, StampsThatStepBackStartAnew) {
  Random random{12};
  Initialisation initialisation{InitialisationConfig{}};
  feed(initialisation, RestingImu{}, 200, random);
  ASSERT_TRUE(initialisation.is_ready());
  feed(initialisation, RestingImu{}, 20, random);
  EXPECT_FALSE(initialisation.is_ready());
}

TEST(Initialisation, ClearStartsAnew) {
  Random random{8};
  Initialisation initialisation{InitialisationConfig{}};
  feed(initialisation, RestingImu{}, 200, random);
  initialisation.clear();
  EXPECT_FALSE(initialisation.is_ready());
}

TEST(Initialisation, ASensorThatReportsNoForceIsNotTakenForAVehicleAtRest) {
  Initialisation initialisation{InitialisationConfig{}};
  for (int i = 0; i < 400; ++i) {
    ImuSample nothing;
    nothing.time = from_ns<HostTime>(5'000'000LL * i);
    initialisation.add(nothing);
  }
  EXPECT_FALSE(initialisation.is_still());
  EXPECT_FALSE(initialisation.is_ready()) << "nor for one that moves: where is down?";
}

TEST(Initialisation, WithoutImuTheVehicleIsLevelAndUncertain) {
  const InitialisationConfig config;
  const InitialState initial =
      initial_state_without_imu(from_ns<HostTime>(77), config, kBaseImu, kImuLidar);
  EXPECT_FALSE(initial.at_rest);
  EXPECT_EQ(initial.filter.time, from_ns<HostTime>(77));
  const Pose T_odom_base = initial.filter.state.T_odom_imu() * kBaseImu.inverse();
  EXPECT_LT(T_odom_base.translation.norm(), 1e-12);
  EXPECT_LT(log_so3(T_odom_base.rotation).norm(), 1e-7);
  EXPECT_GT(initial.filter.covariance(I::kVelocity, I::kVelocity), 1.0);
  expect_covariance(initial.filter.covariance);
}

}  // namespace
}  // namespace slamd
