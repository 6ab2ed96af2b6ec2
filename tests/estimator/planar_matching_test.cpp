// The two matchers of estimator/grid: the search is exact, the refinement unbiased with a true covariance, and both say what
// they do not know.

#include <gtest/gtest.h>

#include "estimator/grid/correlative_matcher.hpp"
#include "estimator/grid/line_matcher.hpp"
#include "tests/estimator/planar_room.hpp"

namespace slamd {
namespace {

using test::laser_scan;
using test::planar_scan;
using test::room;

PlanarScan seen_from(const std::vector<test::Wall>& walls, const PlanarPose& T, double sigma_m, std::mt19937_64& rng) {
  return planar_scan(laser_scan(walls, T, HostTime{std::chrono::seconds{1}}, sigma_m, rng));
}

/// A map of many views, as a drive makes it.
template <class Map>
void fill(Map& map, const std::vector<test::Wall>& walls, std::mt19937_64& rng) {
  for (int i = 0; i < 30; ++i) {
    const PlanarPose T{{0.05 * i - 0.5, 0.02 * i}, 0.03 * i};
    const PlanarScan scan = seen_from(walls, T, 0.01, rng);
    if constexpr (std::is_same_v<Map, LineMap>) map.add(scan, T); else map.add(scan.points, T);
  }
}

/// The search's objective by looking at every cell and angle.
double best_of_all(const LikelihoodPyramid& likelihood, const PlanarScan& scan, const SearchWindow& window) {
  const double step = CorrelativeMatcher::yaw_step(scan.points, likelihood.cell_m());
  const int yaws = static_cast<int>(std::ceil(window.half_yaw_rad / step));
  const int cells = static_cast<int>(std::ceil(window.half_width_m / likelihood.cell_m()));
  std::uint32_t best = 0;
  for (int yaw = -yaws; yaw <= yaws; ++yaw) {
    const Eigen::Matrix2d R = PlanarPose{{}, window.centre.yaw_rad + yaw * step}.rotation();
    std::vector<Eigen::Vector2i> points;
    for (const Eigen::Vector2f& p : scan.points) {
      const Eigen::Vector2d at = (R * p.cast<double>() + window.centre.translation) / likelihood.cell_m();
      points.push_back({static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))});
    }
    for (int y = -cells; y <= cells; ++y) {
      for (int x = -cells; x <= cells; ++x) {
        std::uint32_t sum = 0;
        for (const Eigen::Vector2i& p : points) sum += likelihood.bound(0, p + Eigen::Vector2i{x, y});
        best = std::max(best, sum);
      }
    }
  }
  return best / (255.0 * static_cast<double>(scan.points.size()));
}

TEST(CorrelativeMatcher, FindsTheMaximumThatLookingEverywhereFinds) {
  std::mt19937_64 rng{7};
  LikelihoodPyramid likelihood{LikelihoodConfig{}};
  fill(likelihood, room(), rng);
  CorrelativeMatcher matcher;
  for (int i = 0; i < 8; ++i) {
    const PlanarPose truth{{0.2 + 0.1 * i, 0.1 * i}, 0.2 * i};
    PlanarScan scan = seen_from(room(), truth, 0.01, rng);
    while (scan.points.size() > 60) scan.points.erase(scan.points.begin() + static_cast<std::ptrdiff_t>(rng() % scan.points.size()));
    SearchWindow window;
    window.centre = GroupSe2::plus(truth, {0.21 - 0.05 * i, -0.17, 0.06});
    window.half_width_m = 0.4;
    const std::optional<CorrelativeMatch> found = matcher.match(likelihood, scan.points, window);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->exact);
    EXPECT_DOUBLE_EQ(found->value, best_of_all(likelihood, scan, window));
    EXPECT_LT(GroupSe2::minus(found->T_map_base, truth).head<2>().norm(), 0.1);
  }
}

TEST(CorrelativeMatcher, SaysWhenItsLooksWereNotEnough) {
  std::mt19937_64 rng{7};
  LikelihoodPyramid likelihood{LikelihoodConfig{}};
  fill(likelihood, room(), rng);
  const PlanarScan scan = seen_from(room(), {}, 0.01, rng);
  SearchWindow window;
  window.half_width_m = 1.0;
  window.most_looks = 500;
  CorrelativeMatcher matcher;
  const std::optional<CorrelativeMatch> found = matcher.match(likelihood, scan.points, window);
  EXPECT_TRUE(!found || !found->exact);
}

TEST(LineMatcher, JacobianIsThatOfFiniteDifferences) {
  WallLine line;
  line.mean = {1.0, 2.0};
  line.normal = Eigen::Vector2d{0.6, -0.8};
  const PlanarPose T{{0.3, -0.4}, 0.7};
  const Eigen::Vector2d p{2.5, -1.1};
  Eigen::RowVector3d J;
  line_residual(line, T, p, &J);
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    d[i] = 1e-6;
    const double difference = (line_residual(line, GroupSe2::plus(T, d), p, nullptr) -
                               line_residual(line, GroupSe2::plus(T, -d), p, nullptr)) / 2e-6;
    EXPECT_NEAR(J[i], difference, 1e-7);
  }
}

TEST(LineMatcher, ErrsByMillimetresAndItsCovarianceIsNotTooSure) {
  std::mt19937_64 rng{11};
  LineMap map{LineMapConfig{}};
  fill(map, room(), rng);
  double nees = 0.0, square = 0.0;
  constexpr int kRuns = 60;
  for (int i = 0; i < kRuns; ++i) {
    const PlanarPose truth{{0.01 * i, 0.3}, 0.02 * i};
    const PlanarScan scan = seen_from(room(), truth, 0.01, rng);
    const PlanarPose start = GroupSe2::plus(truth, {0.05, -0.04, 0.02});
    const LineMatch match = match_lines(map, scan, start, {start, 1e-3 * Eigen::Matrix3d::Identity()}, LineMatcherConfig{});
    ASSERT_TRUE(match.ok);
    const Eigen::Vector3d e = GroupSe2::minus(match.T_map_base, truth);
    nees += e.dot(match.covariance.inverse() * e) / 3.0;
    square += e.head<2>().squaredNorm();
    EXPECT_TRUE(match.free_direction.isZero());
  }
  EXPECT_LT(std::sqrt(square / kRuns), 0.005);
  EXPECT_LT(nees / kRuns, 1.5);
  EXPECT_GT(nees / kRuns, 0.02);
}

TEST(LineMatcher, KnowsThatACorridorDoesNotTellItsLength) {
  const std::vector<test::Wall> corridor{{{-50, -1}, {50, -1}}, {{-50, 1}, {50, 1}}};
  std::mt19937_64 rng{3};
  LineMap map{LineMapConfig{}};
  for (int i = 0; i < 20; ++i) map.add(seen_from(corridor, {{0.1 * i, 0.0}, 0.0}, 0.01, rng), {{0.1 * i, 0.0}, 0.0});
  const PlanarPose prior{{1.3, 0.05}, 0.01};
  const Eigen::Matrix3d information = Eigen::Vector3d{25.0, 25.0, 100.0}.asDiagonal();
  const LineMatch match = match_lines(map, seen_from(corridor, {{1.0, 0.0}, 0.0}, 0.01, rng), prior, {prior, information}, LineMatcherConfig{});
  ASSERT_TRUE(match.ok);
  EXPECT_NEAR(match.T_map_base.translation.y(), 0.0, 0.01);
  EXPECT_NEAR(match.T_map_base.translation.x(), 1.3, 0.15) << "along the corridor the prior is kept";
  EXPECT_GT(std::sqrt(match.covariance(0, 0)), 0.1);
  EXPECT_GT(std::abs(match.free_direction.x()), 0.9);
}

TEST(LineMap, TheTwoSidesOfAThinWallStayApart) {
  const std::vector<test::Wall> above{{{-5, 0.05}, {5, 0.05}}};
  const std::vector<test::Wall> below{{{-5, -0.05}, {5, -0.05}}};
  std::mt19937_64 rng{5};
  LineMap map{LineMapConfig{}};
  map.add(seen_from(above, {{0, 2}, 0}, 0.002, rng), {{0, 2}, 0});
  map.add(seen_from(below, {{0, -2}, 0}, 0.002, rng), {{0, -2}, 0});
  WallLine line;
  ASSERT_TRUE(map.line_at({0.0, 0.05}, {0.0, 1.0}, line));
  EXPECT_NEAR(line.mean.y(), 0.05, 0.003);
  ASSERT_TRUE(map.line_at({0.0, -0.05}, {0.0, -1.0}, line));
  EXPECT_NEAR(line.mean.y(), -0.05, 0.003);
}

}  // namespace
}  // namespace slamd
