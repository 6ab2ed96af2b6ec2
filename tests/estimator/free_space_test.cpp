#include "estimator/graph/free_space.hpp"

#include <gtest/gtest.h>

#include "estimator/graph/submap_registration.hpp"
#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

/// A wall across x at the distance, seen from the origin at 1.5 m height, and the ground before it.
Submap wall_at(float distance_m) {
  Submap submap;
  submap.viewpoints = {{0.0F, 0.0F, 1.5F}};
  submap.first_points = {0};
  test::Random random{1};
  const auto noise = [&] { return static_cast<float>(test::normal(random, 0.01)); };
  for (float y = -8.0F; y <= 8.0F; y += 0.15F) {
    for (float z = 0.0F; z <= 3.0F; z += 0.15F) submap.points.emplace_back(distance_m + noise(), y, z);
    for (float x = 3.0F; x < distance_m; x += 0.3F) submap.points.emplace_back(x, y, noise());
  }
  return submap;
}

TEST(FreeSpace, TheSamePlaceIsNotContradicted) {
  const Submap place = wall_at(15.0F);
  PlaneMap target = shape_of(place.points, 1).planes;
  const FreeSpaceCheck check = check_free_space(target, place, Pose{});
  EXPECT_GT(check.rays, 300U);
  EXPECT_LT(check.share(), 0.01);
}

TEST(FreeSpace, RaysThroughAWallAreContradicted) {
  const Submap near = wall_at(10.0F);
  const Submap far = wall_at(15.0F);
  PlaneMap target = shape_of(near.points, 1).planes;
  EXPECT_GT(check_free_space(target, far, Pose{}).share(), 0.3);
}

TEST(FreeSpace, AWallNearerThanSeenByTheOtherIsNoContradictionOfItsOwnRays) {
  const Submap near = wall_at(10.0F);
  PlaneMap target = shape_of(wall_at(15.0F).points, 1).planes;
  EXPECT_LT(check_free_space(target, near, Pose{}).share(), 0.02);
}

TEST(FreeSpace, GrazingRaysOverTheGroundProveNothing) {
  Submap place = wall_at(40.0F);
  PlaneMap target = shape_of(wall_at(15.0F).points, 1).planes;
  std::erase_if(place.points, [](const Eigen::Vector3f& p) { return p.z() > 0.2F; });
  Submap ground = place;
  PlaneMap plain = shape_of(ground.points, 1).planes;
  EXPECT_LT(check_free_space(plain, place, Pose{}).share(), 0.01);
}

}  // namespace
}  // namespace slamd
