// The odometry's chain: relative covariances of any two keyframes in constant time.

#include "estimator/graph/odometry_chain.hpp"

#include <gtest/gtest.h>

#include "estimator/math/se3.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

Vector6d normal6(Random& random, const Vector6d& sigma) {
  Vector6d e;
  for (int i = 0; i < 6; ++i) e[i] = test::normal(random, sigma[i]);
  return e;
}

/// A drive of bent steps with one covariance each.
std::vector<Pose> steps(Random& random, std::size_t count) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back({exp_so3(test::normal3(random, 0.2)), {1.5, test::normal(random, 0.1), test::normal(random, 0.1)}});
  }
  return out;
}

TEST(OdometryChain, CovarianceBetweenTwoKeyframesIsThatOfSampledErrors) {
  Random random{1};
  const std::vector<Pose> measured = steps(random, 12);
  Vector6d sigma;
  sigma << 0.02, 0.01, 0.01, 0.001, 0.001, 0.002;
  OdometryChain chain;
  Pose T;
  chain.add(T, Matrix6d::Zero());
  for (const Pose& step : measured) chain.add(T = T * step, sigma.cwiseAbs2().asDiagonal());
  constexpr int kSamples = 20'000;
  Matrix6d forward = Matrix6d::Zero();
  Matrix6d backward = Matrix6d::Zero();
  for (int k = 0; k < kSamples; ++k) {
    Pose T_true;
    for (std::size_t i = 3; i < 11; ++i) T_true = T_true * boxplus(measured[i], normal6(random, sigma));
    const Vector6d e = boxminus(T_true, chain.relative(3, 11));
    const Vector6d b = boxminus(T_true.inverse(), chain.relative(11, 3));
    forward += e * e.transpose() / kSamples;
    backward += b * b.transpose() / kSamples;
  }
  const Matrix6d expected = chain.relative_covariance(3, 11);
  EXPECT_LT((forward - expected).norm(), 0.05 * expected.norm());
  const Matrix6d reversed = chain.relative_covariance(11, 3);
  EXPECT_LT((backward - reversed).norm(), 0.05 * reversed.norm());
}

TEST(OdometryChain, OfAKeyframeToItselfIsZeroAndOneStepIsItsOwnCovariance) {
  Random random{2};
  OdometryChain chain;
  Pose T;
  chain.add(T, Matrix6d::Zero());
  const Matrix6d covariance = Vector6d{Vector6d::LinSpaced(1.0, 2.0)}.asDiagonal();
  for (const Pose& step : steps(random, 5)) chain.add(T = T * step, covariance);
  EXPECT_TRUE(chain.relative_covariance(3, 3).isZero(0.0));
  EXPECT_TRUE(chain.relative_covariance(3, 4).isApprox(covariance, 1e-9));
}

}  // namespace
}  // namespace slamd
