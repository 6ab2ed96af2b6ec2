#include "estimator/graph/bird_view.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

/// Poles at random places, and the ground at a height.
Submap poles(std::uint64_t seed, int count) {
  Random random{seed};
  Submap submap;
  for (int i = 0; i < count; ++i) {
    const double x = test::uniform(random, -35.0, 35.0);
    const double y = test::uniform(random, -35.0, 35.0);
    for (const double z : {0.0, 0.5, 1.0, 1.5, 2.0}) submap.points.emplace_back(x, y, z);
  }
  for (int x = -30; x <= 30; ++x) {
    for (int y = -30; y <= 30; ++y) submap.points.emplace_back(x, y, 0.0F);
  }
  return submap;
}

/// The same points as seen from a frame that lies at T in theirs.
Submap seen_from(const Submap& submap, const TurnAndShift& T, double height_m) {
  Submap moved = submap;
  const Eigen::Rotation2Df R{static_cast<float>(-T.yaw_rad)};
  for (Eigen::Vector3f& p : moved.points) {
    p.x() -= static_cast<float>(T.x_m);
    p.y() -= static_cast<float>(T.y_m);
    p.head<2>() = (R * p.head<2>()).eval();
    p.z() -= static_cast<float>(height_m);
  }
  return moved;
}

TEST(BirdViewSearch, FindsTurnShiftAndHeightFarFromTheGuess) {
  const Submap target = poles(1, 60);
  const TurnAndShift truth{6.3, -9.7, 0.4};
  const PlanarMatch match = search(BirdView{target}, BirdView{seen_from(target, truth, 1.5)}, {}, {15.0, 0.6});
  EXPECT_NEAR(match.T_target_source.x_m, truth.x_m, 0.6);
  EXPECT_NEAR(match.T_target_source.y_m, truth.y_m, 0.6);
  EXPECT_NEAR(match.T_target_source.yaw_rad, truth.yaw_rad, 0.03);
  EXPECT_NEAR(match.height_m, 1.5, 0.05);
  EXPECT_GT(match.score, 0.4);  // a pole falls into one of four cells after the turn
  EXPECT_LT(match.runner_up, 0.7 * match.score);
}

/// The score of one turn and shift, cell by cell.
int score_at(const BirdView& target, const BirdView& source, double yaw_rad, int dx, int dy) {
  const auto c = static_cast<float>(std::cos(yaw_rad));
  const auto s = static_cast<float>(std::sin(yaw_rad));
  int sum = 0;
  for (const Eigen::Vector2f& p : source.cells()) {
    sum += target.at(0, BirdView::index(c * p.x() - s * p.y() + 0.0F) + dx, BirdView::index(s * p.x() + c * p.y() + 0.0F) + dy);
  }
  return sum;
}

TEST(BirdViewSearch, IsAsGoodAsTryingEveryTurnAndShift) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const BirdView target{poles(seed, 40)};
    const BirdView source{poles(seed + 100, 40)};  // another place: many poor maxima
    int best = 0;
    for (int step = -4; step <= 4; ++step) {
      for (int dx = -12; dx <= 12; ++dx) {
        for (int dy = -12; dy <= 12; ++dy) {
          best = std::max(best, score_at(target, source, step * 1.5 * std::numbers::pi / 180.0, dx, dy));
        }
      }
    }
    const PlanarMatch match = search(target, source, {}, {6.0, 6.0 * std::numbers::pi / 180.0});
    EXPECT_NEAR(match.score, best / (2.0 * static_cast<double>(source.cells().size())), 1e-12);
  }
}

TEST(BirdViewSearch, ARepeatingPlaceHasARunnerUpAsGoodAsItsBest) {
  Submap grid;
  for (int x = -32; x <= 32; x += 8) {
    for (int y = -32; y <= 32; y += 8) {
      for (const double z : {0.0, 1.0, 2.0}) grid.points.emplace_back(x + 0.2, y + 0.2, z);
    }
  }
  const PlanarMatch match = search(BirdView{grid}, BirdView{grid}, {}, {12.0, 0.05});
  EXPECT_GT(match.runner_up, 0.75 * match.score);
}

TEST(BirdViewSearch, NothingStandingGivesNoScore) {
  const Submap plain = poles(1, 0);
  const PlanarMatch match = search(BirdView{plain}, BirdView{plain}, {1.0, 2.0, 0.3}, {5.0, 0.1});
  EXPECT_EQ(match.score, 0.0);
  EXPECT_EQ(match.T_target_source.x_m, 1.0);
}

}  // namespace
}  // namespace slamd
