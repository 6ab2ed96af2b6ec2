// Between and prior factors of both groups: convention, Jacobians, and the two measures of rotation.

#include "estimator/graph/between_factor.hpp"

#include <gtest/gtest.h>

#include "estimator/graph/group_se2.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

template <class Group>
struct Sampler;
template <>
struct Sampler<GroupSe3> {
  static Pose pose(Random& random) { return test::random_pose(random, 5.0); }
};
template <>
struct Sampler<GroupSe2> {
  static PlanarPose pose(Random& random) {
    return {Eigen::Vector2d{test::normal(random, 5.0), test::normal(random, 5.0)}, test::uniform(random, -3.1, 3.1)};
  }
};

template <class Group>
typename Group::Tangent random_tangent(Random& random, double sigma) {
  typename Group::Tangent d;
  for (int i = 0; i < Group::kDof; ++i) d[i] = test::normal(random, sigma);
  return d;
}

template <class Group>
typename Group::Matrix random_information(Random& random) {
  typename Group::Matrix A;
  for (int i = 0; i < A.size(); ++i) A.data()[i] = test::normal(random);
  return A * A.transpose() + Group::Matrix::Identity();
}

template <class Group>
class Groups : public testing::Test {};
using BothGroups = testing::Types<GroupSe2, GroupSe3>;
TYPED_TEST_SUITE(Groups, BothGroups);

TYPED_TEST(Groups, MinusIsTheInverseOfPlus) {
  Random random{1};
  for (int i = 0; i < 100; ++i) {
    const auto T = Sampler<TypeParam>::pose(random);
    const auto d = random_tangent<TypeParam>(random, 0.5);
    EXPECT_LT((TypeParam::minus(TypeParam::plus(T, d), T) - d).norm(), 1e-12);
  }
}

TYPED_TEST(Groups, TheErrorIsWhatTheMeasurementLacksOnItsRight) {
  Random random{2};
  for (int i = 0; i < 100; ++i) {
    const auto T_map_a = Sampler<TypeParam>::pose(random);
    const auto measured = Sampler<TypeParam>::pose(random);
    const auto e = random_tangent<TypeParam>(random, 0.4);
    const auto T_map_b = T_map_a * TypeParam::plus(measured, e);
    const auto found =
        TypeParam::between_error(T_map_a, T_map_b, measured, RotationError::kLog, nullptr, nullptr);
    EXPECT_LT((found - e).norm(), 1e-12);
  }
}

TYPED_TEST(Groups, ChordalErrorSquaredIsHalfTheFrobeniusNorm) {
  Random random{3};
  for (int i = 0; i < 100; ++i) {
    const auto a = Sampler<TypeParam>::pose(random);
    const auto b = Sampler<TypeParam>::pose(random);
    const auto m = Sampler<TypeParam>::pose(random);
    const auto e = TypeParam::between_error(a, b, m, RotationError::kChordal, nullptr, nullptr);
    constexpr int d = TypeParam::kDimension;
    const double frobenius =
        (TypeParam::rotation(b) - TypeParam::rotation(a) * TypeParam::rotation(m)).squaredNorm();
    EXPECT_NEAR(e.template tail<TypeParam::kDof - d>().squaredNorm(), 0.5 * frobenius, 1e-9);
  }
}

TYPED_TEST(Groups, BetweenJacobiansAreThoseOfFiniteDifferences) {
  Random random{4};
  for (const RotationError kind : {RotationError::kLog, RotationError::kChordal}) {
    for (const double error : {0.0, 1e-8, 0.3, 1.0}) {
      const auto a = Sampler<TypeParam>::pose(random);
      const auto m = Sampler<TypeParam>::pose(random);
      const auto b = a * TypeParam::plus(m, random_tangent<TypeParam>(random, error));
      const auto W = square_root(random_information<TypeParam>(random));
      test::expect_jacobians(BetweenFactor<TypeParam>{m, W, kind},
                             {test::variable<TypeParam>(a), test::variable<TypeParam>(b)});
    }
  }
}

TYPED_TEST(Groups, PriorJacobianIsThatOfFiniteDifferences) {
  Random random{5};
  for (const double error : {0.0, 1e-8, 0.3}) {
    const auto m = Sampler<TypeParam>::pose(random);
    const auto x = TypeParam::plus(m, random_tangent<TypeParam>(random, error));
    const auto W = square_root(random_information<TypeParam>(random));
    test::expect_jacobians(PriorFactor<TypeParam>{m, W}, {test::variable<TypeParam>(x)});
  }
}

TYPED_TEST(Groups, ThePriorsErrorIsWhatTheMeasurementLacksOnItsRight) {
  Random random{6};
  const auto m = Sampler<TypeParam>::pose(random);
  const auto e = random_tangent<TypeParam>(random, 0.3);
  const typename TypeParam::Matrix W = TypeParam::Matrix::Identity();
  const auto r = test::residual_of(PriorFactor<TypeParam>{m, W}, {test::variable<TypeParam>(TypeParam::plus(m, e))});
  EXPECT_LT((r - e).norm(), 1e-12);
}

TYPED_TEST(Groups, WhiteningGivesTheQuadraticFormOfTheInformation) {
  Random random{7};
  const auto information = random_information<TypeParam>(random);
  const auto e = random_tangent<TypeParam>(random, 1.0);
  EXPECT_NEAR((square_root(information) * e).squaredNorm(), e.dot(information * e), 1e-9);
}

}  // namespace
}  // namespace slamd
