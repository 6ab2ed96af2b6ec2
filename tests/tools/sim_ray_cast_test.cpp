// The ray caster of slam-sim against brute force and against marching.

#include <gtest/gtest.h>

#include "tools/slam-sim/world/rng.hpp"
#include "tools/slam-sim/world/world.hpp"

namespace slamd::sim {
namespace {

using Eigen::Vector3d;

Vector3d random_direction(Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return Vector3d(x, y, z).normalized();
}

std::vector<Primitive> random_bodies(Rng& rng, int count) {
  std::vector<Primitive> bodies;
  for (int i = 0; i < count; ++i) {
    const Vector3d centre(rng.uniform(-40, 40), rng.uniform(-40, 40), rng.uniform(-5, 10));
    const Vector3d half(rng.uniform(0.1, 3), rng.uniform(0.1, 3), rng.uniform(0.1, 3));
    Primitive body = make_box(centre, half, rng.uniform(0, 6), materials::kConcrete);
    body.R_world_body = Eigen::AngleAxisd(rng.uniform(0, 3), random_direction(rng)).toRotationMatrix();
    body.shape = static_cast<Shape>(i % 4);
    bodies.push_back(body);
  }
  return bodies;
}

/// Signed "inside" test of a point, independent of the intersection formulas.
bool contains(const Primitive& body, const Vector3d& p_world) {
  const Vector3d p = body.R_world_body.transpose() * (p_world - body.centre);
  const Vector3d& h = body.half;
  switch (body.shape) {
    case Shape::kBox:
      return (p.cwiseAbs() - h).maxCoeff() <= 0.0;
    case Shape::kEllipsoid:
      return p.cwiseQuotient(h).norm() <= 1.0;
    case Shape::kCylinder:
      return std::abs(p.z()) <= h.z() && p.head<2>().norm() <= h.x();
    case Shape::kCone:
      return std::abs(p.z()) <= h.z() && p.head<2>().norm() <= h.x() * (h.z() - p.z()) / (2 * h.z());
  }
  return false;
}

TEST(SimRayCast, TheHierarchyGivesWhatTestingEveryBodyGives) {
  Rng rng{7, Stream::kWorld};
  const Bvh bvh{random_bodies(rng, 400)};
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d origin(rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-10, 20));
    const Ray ray{origin, random_direction(rng), 120.0};
    Hit fast, slow;
    bvh.cast(ray, fast);
    for (const Primitive& body : bvh.bodies()) intersect(body, ray, slow);
    ASSERT_EQ(fast.range, slow.range);
    ASSERT_TRUE(!fast || fast.normal.isApprox(slow.normal));
    hits += fast ? 1 : 0;
  }
  EXPECT_GT(hits, 500);
}

TEST(SimRayCast, AHitLiesOnTheSurfaceOfItsBodyAndItsNormalPointsOutwards) {
  Rng rng{8, Stream::kWorld};
  const auto bodies = random_bodies(rng, 200);
  std::array<int, 4> hits{};
  for (int i = 0; i < 6000; ++i) {
    const Primitive& body = bodies[static_cast<std::size_t>(i) % bodies.size()];
    const Vector3d origin = body.centre + 10.0 * random_direction(rng);
    const Vector3d aim = body.centre + 0.8 * body.half.norm() * random_direction(rng);
    const Ray ray{origin, (aim - origin).normalized(), 120.0};
    Hit hit;
    intersect(body, ray, hit);
    // Marching finds a body no finer than its step, but never one that the formula misses.
    double marched = -1.0;
    for (double t = 0.0; t < 25.0 && marched < 0.0; t += 0.02) {
      if (contains(body, origin + t * ray.direction)) marched = t;
    }
    if (marched >= 0.0) {
      ASSERT_TRUE(hit) << "shape " << static_cast<int>(body.shape);
      ASSERT_LE(hit.range, marched + 1e-9);
    }
    if (!hit) continue;
    ++hits[static_cast<std::size_t>(body.shape)];
    ASSERT_TRUE(contains(body, origin + (hit.range + 1e-6) * ray.direction) || marched < 0.0);
    ASSERT_FALSE(contains(body, origin + (hit.range - 1e-6) * ray.direction));
    ASSERT_LT(hit.normal.dot(ray.direction), 1e-9);
    ASSERT_NEAR(hit.normal.norm(), 1.0, 1e-9);
  }
  for (const int count : hits) EXPECT_GT(count, 150);
}

TEST(SimRayCast, PorousBodiesReturnTheBeamInsideOrLetItPass) {
  const Primitive crown = make_upright(Shape::kEllipsoid, {10.0, 0.0, 0.0}, {2.0, 2.0, 2.0}, materials::kFoliage);
  Ray ray{Vector3d::Zero(), Vector3d::UnitX(), 100.0};
  ray.porosity_draw = 2.0;
  Hit hit;
  intersect(crown, ray, hit);
  EXPECT_NEAR(hit.range, 8.0 + 2.0 * static_cast<double>(materials::kFoliage.porous_depth_m), 1e-6);
  ray.porosity_draw = 20.0;
  Hit none;
  intersect(crown, ray, none);
  EXPECT_FALSE(none);
}

TEST(SimRayCast, TheGroundIsHitExactlyWhereTheRayMeetsItsHeight) {
  Rng rng{9, Stream::kWorld};
  const auto hills = [](double x, double y) { return 2.0 * std::sin(x / 9.0) + 1.5 * std::cos(y / 7.0); };
  const HeightField ground({-100, -100}, {100, 100}, 1.0, hills);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Vector3d origin(rng.uniform(-90, 90), rng.uniform(-90, 90), 0.0);
    origin.z() = ground.height(origin.x(), origin.y()) + rng.uniform(0.3, 4.0);
    const Ray ray{origin, random_direction(rng), 80.0};
    Hit hit;
    ground.cast(ray, hit);
    const auto above = [&](double t) {
      const Vector3d p = origin + t * ray.direction;
      return p.z() - ground.height(p.x(), p.y());
    };
    const auto outside = [&](double t) { return (origin + t * ray.direction).head<2>().cwiseAbs().maxCoeff() > 100.0; };
    const double end = hit ? hit.range - 1e-6 : 80.0;
    for (double t = 0.0; t < end && !outside(t); t += 0.05) ASSERT_GT(above(t), -1e-9) << "passed through the ground";
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(above(hit.range), 0.0, 1e-8);
    ASSERT_LT(hit.normal.dot(ray.direction), 0.0);
  }
  EXPECT_GT(hits, 700);
}

TEST(SimRayCast, VerticalAndAxisParallelRaysAreNoSpecialCase) {
  const HeightField ground({-50, -50}, {50, 50}, 1.0, [](double, double) { return 1.0; });
  Hit down, along;
  ground.cast(Ray{{3.0, 4.0, 6.0}, -Vector3d::UnitZ(), 100.0}, down);
  EXPECT_NEAR(down.range, 5.0, 1e-12);
  ground.cast(Ray{{3.0, 4.0, 6.0}, Vector3d::UnitX(), 100.0}, along);
  EXPECT_FALSE(along);
}

class SimWorlds : public testing::TestWithParam<WorldKind> {};

TEST_P(SimWorlds, AreRepeatableAndLeaveTheLaneFree) {
  const World world = make_world(GetParam(), 3), again = make_world(GetParam(), 3);
  ASSERT_EQ(world.bodies.bodies().size(), again.bodies.bodies().size());
  for (const Eigen::Vector2d& p : world.loop.points) {
    const double z = world.ground.height(p.x(), p.y());
    ASSERT_EQ(z, again.ground.height(p.x(), p.y()));
    // Nothing stands on the lane: looking along the ground from 1.5 m above, nothing solid is nearer than 0.9 m.
    for (int i = 0; i < 16; ++i) {
      Hit hit;
      const double angle = i * 0.3927;
      world.bodies.cast(Ray{{p.x(), p.y(), z + 1.0}, {std::cos(angle), std::sin(angle), 0.0}, 50.0}, hit);
      ASSERT_GT(hit.range, 0.9) << p.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SimWorlds,
                         testing::Values(WorldKind::kCampus, WorldKind::kCorridor, WorldKind::kParking,
                                         WorldKind::kOpenField, WorldKind::kUrban, WorldKind::kHills));

}  // namespace
}  // namespace slamd::sim
