#include "estimator/math/lie.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Random;

/// Rotation vectors at all the places where formulas change or lose digits: identity, tiny, about the switch to the
/// series (1e-4), moderate, near and at pi.
std::vector<Vector3d> rotation_vectors() {
  Random random{1};
  std::vector<Vector3d> out{Vector3d::Zero()};
  for (const double angle : {1e-12, 1e-8, 9.9e-5, 1.01e-4, 1e-3, 0.1, 1.0, 2.0, 3.0, std::numbers::pi - 1e-4,
                             std::numbers::pi - 1e-8}) {
    for (const Vector3d& axis : {Vector3d{1, 0, 0}, Vector3d{0, -1, 0}, test::unit3(random), test::unit3(random)})
      out.push_back(angle * axis);
  }
  return out;
}

Matrix3d matrix(const Vector3d& theta) { return exp_so3(theta).toRotationMatrix(); }

class EveryRotation : public ::testing::TestWithParam<Vector3d> {};
INSTANTIATE_TEST_SUITE_P(Lie, EveryRotation, ::testing::ValuesIn(rotation_vectors()));

TEST(Lie, SkewIsTheCrossProduct) {
  Random random{2};
  const Vector3d a = test::normal3(random), b = test::normal3(random);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
  EXPECT_EQ(skew(a), Matrix3d(-skew(a).transpose()));
}

TEST_P(EveryRotation, ExpIsAUnitQuaternionAndEqualsRodrigues) {
  const Vector3d theta = GetParam();
  EXPECT_NEAR(exp_so3(theta).norm(), 1.0, 1e-15);
  const double angle = theta.norm();
  const Vector3d axis = angle > 0.0 ? Vector3d(theta / angle) : Vector3d::UnitX();
  EXPECT_LT((matrix(theta) - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 1e-14);
}

TEST_P(EveryRotation, LogIsTheInverseOfExp) {
  const Vector3d theta = GetParam();
  EXPECT_LT((log_so3(exp_so3(theta)) - theta).norm(), 1e-15 + 1e-14 * theta.norm());
}

TEST_P(EveryRotation, LogDoesNotDependOnTheQuaternionsSign) {
  const Quaterniond q = exp_so3(GetParam());
  const Quaterniond negated{-q.w(), -q.x(), -q.y(), -q.z()};
  EXPECT_LT((log_so3(negated) - log_so3(q)).norm(), 1e-14);
}

TEST_P(EveryRotation, GroupLawsHold) {
  Random random{3};
  const Quaterniond a = exp_so3(GetParam()), b = test::random_rotation(random), c = test::random_rotation(random);
  EXPECT_LT((((a * b) * c).coeffs() - (a * (b * c)).coeffs()).norm(), 1e-14);
  EXPECT_LT(log_so3(a * exp_so3(-GetParam())).norm(), 1e-14) << "Exp(-theta) is the inverse";
  EXPECT_LT((matrix(0.3 * GetParam()) * matrix(0.7 * GetParam()) - matrix(GetParam())).norm(), 1e-14);
}

TEST_P(EveryRotation, RightJacobianEqualsFiniteDifferences) {
  const Vector3d theta = GetParam();
  const auto turned = [&](const Vector3d& d) { return log_so3(exp_so3(theta).conjugate() * exp_so3(theta + d)); };
  const Matrix3d numeric = test::central_differences<3, 3>(turned);
  EXPECT_LT((right_jacobian_so3(theta) - numeric).norm(), 1e-9);
}

TEST_P(EveryRotation, InverseRightJacobianIsTheInverse) {
  const Vector3d theta = GetParam();
  EXPECT_LT((right_jacobian_so3(theta) * right_jacobian_inverse_so3(theta) - Matrix3d::Identity()).norm(), 1e-9);
}

TEST_P(EveryRotation, InverseRightJacobianEqualsFiniteDifferencesOfLog) {
  const Vector3d theta = GetParam();
  if (theta.norm() > std::numbers::pi - 1e-3) return;  // log jumps at pi: the test above has to do there
  const auto logarithm = [&](const Vector3d& d) { return Vector3d(log_so3(exp_so3(theta) * exp_so3(d))); };
  EXPECT_LT((right_jacobian_inverse_so3(theta) - test::central_differences<3, 3>(logarithm)).norm(), 1e-8);
}

std::vector<Vector3d> gravity_vectors() {
  Random random{4};
  std::vector<Vector3d> out{{0, 0, -9.8}, {0, 0, 9.8}, {9.8, 0, 0}, {-1, 0, 0}, {0, 2, 0}, {0.9, 0.43588989, 0}};
  for (int i = 0; i < 20; ++i) out.push_back(9.8 * test::unit3(random));
  return out;
}

class EveryDirection : public ::testing::TestWithParam<Vector3d> {};
INSTANTIATE_TEST_SUITE_P(Lie, EveryDirection, ::testing::ValuesIn(gravity_vectors()));

TEST_P(EveryDirection, BasisIsOrthonormalAndTangent) {
  const Matrix32d basis = tangent_basis_s2(GetParam());
  EXPECT_LT((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-14);
  EXPECT_LT((basis.transpose() * GetParam()).norm(), 1e-13);
}

TEST_P(EveryDirection, BoxplusKeepsTheNormAndBoxminusUndoesIt) {
  Random random{5};
  for (const double size : {0.0, 1e-9, 1e-4, 0.1, 1.0, 3.0}) {
    const double angle = test::uniform(random, 0.0, 6.28);
    const Vector2d d{size * std::cos(angle), size * std::sin(angle)};
    const Vector3d moved = boxplus_s2(GetParam(), d);
    EXPECT_NEAR(moved.norm(), GetParam().norm(), 1e-13);
    EXPECT_LT((boxminus_s2(moved, GetParam()) - d).norm(), 1e-13) << "size " << size;
  }
}

TEST_P(EveryDirection, BoxplusUndoesBoxminus) {
  Random random{6};
  for (int i = 0; i < 20; ++i) {
    const Vector3d to = GetParam().norm() * test::unit3(random);
    const Vector2d d = boxminus_s2(to, GetParam());
    EXPECT_LT((boxplus_s2(GetParam(), d) - to).norm(), 1e-12);
  }
}

TEST(Lie, SymmetriseGivesTheMean) {
  Eigen::Matrix2d m;
  m << 1.0, 2.0, 4.0, 3.0;
  symmetrise(m);
  EXPECT_EQ(m(0, 1), 3.0);
  EXPECT_EQ(m(1, 0), 3.0);
  EXPECT_EQ(m(0, 0), 1.0);
}

}  // namespace
}  // namespace slamd
