#include "estimator/graph/place_descriptor.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/box_town.hpp"

namespace slamd {
namespace {

using test::BoxTown;
using test::Random;

Submap submap(const BoxTown& town, const Pose& T_map_base, std::uint64_t seed) {
  Random random{seed};
  Submap result;
  for (const CloudPoint& p : town.scan(T_map_base, random)) result.points.emplace_back(p.x, p.y, p.z);
  return result;
}

Pose turned(const Pose& T, double yaw_rad) {
  return T * Pose{Eigen::Quaterniond{Eigen::AngleAxisd{yaw_rad, Eigen::Vector3d::UnitZ()}}};
}

TEST(PlaceDescriptor, ATurnedPlaceIsTheSamePlaceAndTheTurnIsFound) {
  const BoxTown town = BoxTown::around_circle(60.0, 3);
  const Pose T_map_base = test::pose_on_circle(60.0, 20.0);
  const PlaceDescriptor here = describe(submap(town, T_map_base, 1));
  for (const double yaw_rad : {0.0, 0.6, 2.0, -2.9}) {
    const PlaceMatch found = match(here, describe(submap(town, turned(T_map_base, yaw_rad), 2)));
    EXPECT_LT(found.distance, 0.15);
    EXPECT_NEAR(std::remainder(found.yaw_rad - yaw_rad, 2.0 * std::numbers::pi), 0.0, 0.11);
  }
}

TEST(PlaceDescriptor, OtherPlacesAreFartherThanTheSameOne) {
  const BoxTown town = BoxTown::around_circle(60.0, 3);
  const PlaceDescriptor here = describe(submap(town, test::pose_on_circle(60.0, 20.0), 1));
  const double same = match(here, describe(submap(town, test::pose_on_circle(60.0, 20.5, 0.5), 2))).distance;
  for (double along_m = 60.0; along_m < 340.0; along_m += 20.0) {
    EXPECT_GT(match(here, describe(submap(town, test::pose_on_circle(60.0, along_m), 3))).distance, same);
  }
}

TEST(PlaceDescriptor, AnEmptyPlaceMatchesNothing) {
  const PlaceDescriptor nothing = describe(Submap{});
  EXPECT_EQ(match(nothing, nothing).distance, 1.0);
}

}  // namespace
}  // namespace slamd
