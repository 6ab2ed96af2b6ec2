// The correlative search against a look at every pose of its window, and its bounds.
#include "estimator/grid/correlative_matcher.hpp"

#include <gtest/gtest.h>

#include <random>

namespace slamd {
namespace {

/// Points along random walls within 8 m.
std::vector<Eigen::Vector2f> walls(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<float> place{-8.0F, 8.0F}, share{0.0F, 1.0F};
  std::vector<Eigen::Vector2f> points;
  while (static_cast<int>(points.size()) < count) {
    const Eigen::Vector2f a{place(random), place(random)}, b{place(random), place(random)};
    for (int i = 0; i < 40; ++i) points.push_back(a + share(random) * (b - a));
  }
  return points;
}

struct Best {
  double score = 0.0;
  PlanarPose pose;
};

/// The same angles and cells, one after the other.
Best look_everywhere(const LikelihoodPyramid& likelihood, const std::vector<Eigen::Vector2f>& points, const SearchWindow& window) {
  const double step = CorrelativeMatcher::yaw_step(points, likelihood.cell_m());
  const int yaws = static_cast<int>(std::ceil(window.half_yaw_rad / step));
  const int cells = static_cast<int>(std::ceil(window.half_width_m / likelihood.cell_m()));
  Best best;
  for (int k = -yaws; k <= yaws; ++k) {
    const PlanarPose turned{window.centre.translation, window.centre.yaw_rad + k * step};
    for (int y = -cells; y <= cells; ++y) {
      for (int x = -cells; x <= cells; ++x) {
        double sum = 0.0;
        for (const Eigen::Vector2f& point : points) {
          const Eigen::Vector2d p = (turned.rotation() * point.cast<double>() + turned.translation) / likelihood.cell_m();
          sum += likelihood.bound(0, {static_cast<int>(std::floor(p.x())) + x, static_cast<int>(std::floor(p.y())) + y});
        }
        const double score = sum / (255.0 * static_cast<double>(points.size()));
        if (score <= best.score) continue;
        best = {score, {window.centre.translation + likelihood.cell_m() * Eigen::Vector2d{x, y}, turned.yaw_rad}};
      }
    }
  }
  return best;
}

TEST(CorrelativeMatcher, FindsTheExactMaximumOfTheWindow) {
  std::mt19937_64 random{3};
  std::uniform_real_distribution<double> off{-0.25, 0.25};
  CorrelativeMatcher matcher;
  for (int trial = 0; trial < 8; ++trial) {
    const std::vector<Eigen::Vector2f> scene = walls(random, 400);
    LikelihoodPyramid likelihood{LikelihoodConfig{}};
    likelihood.add(scene, PlanarPose{{0.3, -0.2}, 0.1});
    const std::vector<Eigen::Vector2f> some{scene.begin(), scene.begin() + 60};
    SearchWindow window;
    window.centre = {{0.3 + off(random), -0.2 + off(random)}, 0.1 + 0.2 * off(random)};
    window.half_width_m = 0.4;
    window.half_yaw_rad = 0.08;
    window.most_looks = 10'000'000;
    const auto found = matcher.match(likelihood, some, window);
    const Best best = look_everywhere(likelihood, some, window);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->exact);
    EXPECT_NEAR(found->score, best.score, 1e-9) << "trial " << trial;
    EXPECT_NEAR((found->T_map_base.translation - Eigen::Vector2d(0.3, -0.2)).norm(), 0.0, 0.08);
    EXPECT_NEAR(found->T_map_base.yaw_rad, 0.1, 0.01);
  }
}

TEST(CorrelativeMatcher, ABlockIsNeverWorthLessThanItsBestCell) {
  std::mt19937_64 random{5};
  LikelihoodPyramid likelihood{LikelihoodConfig{}};
  likelihood.add(walls(random, 200), PlanarPose{});
  std::uniform_int_distribution<int> cell{-200, 200};
  for (int i = 0; i < 2'000; ++i) {
    const Eigen::Vector2i at{cell(random), cell(random)};
    for (int level = 1; level < likelihood.levels(); ++level) {
      const Eigen::Vector2i inside = at + Eigen::Vector2i{std::abs(cell(random)) % (1 << level), std::abs(cell(random)) % (1 << level)};
      ASSERT_GE(likelihood.bound(level, at), likelihood.bound(0, inside));
    }
  }
}

TEST(CorrelativeMatcher, WhereNothingFitsItSaysSo) {
  std::mt19937_64 random{7};
  LikelihoodPyramid likelihood{LikelihoodConfig{}};
  likelihood.add(walls(random, 200), PlanarPose{{500.0, 0.0}, 0.0});
  SearchWindow window;
  window.least_score = 0.1;
  CorrelativeMatcher matcher;
  EXPECT_FALSE(matcher.match(likelihood, walls(random, 40), window));
  EXPECT_FALSE(matcher.match(likelihood, {}, window));
}

TEST(CorrelativeMatcher, OutOfLooksItTellsThatItIsNotExact) {
  std::mt19937_64 random{9};
  const std::vector<Eigen::Vector2f> scene = walls(random, 200);
  LikelihoodPyramid likelihood{LikelihoodConfig{}};
  likelihood.add(scene, PlanarPose{});
  SearchWindow window;
  window.half_width_m = 3.0;
  window.half_yaw_rad = 0.5;
  window.most_looks = 500;
  const auto found = CorrelativeMatcher{}.match(likelihood, scene, window);
  EXPECT_FALSE(found && found->exact);
}

}  // namespace
}  // namespace slamd
