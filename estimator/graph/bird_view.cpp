#include "estimator/graph/bird_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace slamd {

namespace {

constexpr float kMinSpread_m = 0.8F;  // between the lowest and the highest point of a cell in which something stands
constexpr double kYawStep_rad = 1.5 * std::numbers::pi / 180.0;

constexpr std::size_t flat(int ix, int iy) { return static_cast<std::size_t>(iy * BirdView::kSize + ix); }
constexpr bool inside(int ix, int iy) { return ix >= 0 && iy >= 0 && ix < BirdView::kSize && iy < BirdView::kSize; }

/// The source's cells at one heading, as whole cells of the target's grid.
struct TurnedCells {
  double yaw_rad = 0.0;
  std::vector<std::array<int, 2>> cells;
};

/// A square of 2^level x 2^level shifts at one heading.
struct Branch {
  const TurnedCells* turned = nullptr;
  int level = 0;
  int dx = 0, dy = 0;
  int bound = 0;
};

/// What is not to be found again.
struct Exclusion {
  int dx = 0, dy = 0;
  int radius = -1;
};

int bound(const BirdView& target, const Branch& branch) {
  int sum = 0;
  for (const auto& [ix, iy] : branch.turned->cells) sum += target.at(branch.level, ix + branch.dx, iy + branch.dy);
  return sum;
}

bool excluded(const Branch& leaf, const Exclusion& exclusion) {
  return std::abs(leaf.dx - exclusion.dx) <= exclusion.radius && std::abs(leaf.dy - exclusion.dy) <= exclusion.radius;
}

/// Depth first, the most promising quarter first; `best` only ever gets better.
void descend(const BirdView& target, const Branch& branch, const Exclusion& exclusion, int limit, Branch& best) {
  if (branch.bound <= best.bound) return;
  if (branch.level == 0) {
    if (!excluded(branch, exclusion)) best = branch;
    return;
  }
  const int half = 1 << (branch.level - 1);
  std::array<Branch, 4> quarters;
  std::size_t count = 0;
  for (const int y : {0, half}) {
    for (const int x : {0, half}) {
      Branch quarter{branch.turned, branch.level - 1, branch.dx + x, branch.dy + y, 0};
      if (quarter.dx > limit || quarter.dy > limit) continue;
      quarter.bound = bound(target, quarter);
      quarters[count++] = quarter;
    }
  }
  std::stable_sort(quarters.begin(), quarters.begin() + count,
                   [](const Branch& a, const Branch& b) { return a.bound > b.bound; });
  for (std::size_t i = 0; i < count; ++i) descend(target, quarters[i], exclusion, limit, best);
}

std::vector<TurnedCells> turn(const BirdView& source, const TurnAndShift& guess, double yaw_window_rad) {
  const int steps = static_cast<int>(std::min(std::ceil(yaw_window_rad / kYawStep_rad), std::numbers::pi / kYawStep_rad));
  std::vector<TurnedCells> result;
  for (int step = -steps; step <= steps; ++step) {
    TurnedCells turned;
    turned.yaw_rad = guess.yaw_rad + step * kYawStep_rad;
    const auto c = static_cast<float>(std::cos(turned.yaw_rad));
    const auto s = static_cast<float>(std::sin(turned.yaw_rad));
    for (const Eigen::Vector2f& p : source.cells()) {
      turned.cells.push_back({BirdView::index(c * p.x() - s * p.y() + static_cast<float>(guess.x_m)),
                              BirdView::index(s * p.x() + c * p.y() + static_cast<float>(guess.y_m))});
    }
    result.push_back(std::move(turned));
  }
  return result;
}

std::vector<Branch> roots(const BirdView& target, const std::vector<TurnedCells>& turns, int limit) {
  constexpr int kTop = BirdView::kLevels - 1;
  std::vector<Branch> result;
  for (const TurnedCells& turned : turns) {
    for (int dy = -limit; dy <= limit; dy += 1 << kTop) {
      for (int dx = -limit; dx <= limit; dx += 1 << kTop) {
        result.push_back({&turned, kTop, dx, dy, 0});
        result.back().bound = bound(target, result.back());
      }
    }
  }
  std::ranges::stable_sort(result, [](const Branch& a, const Branch& b) { return a.bound > b.bound; });
  return result;
}

Branch best_leaf(const BirdView& target, const std::vector<Branch>& roots, int limit, const Exclusion& exclusion) {
  Branch best;
  for (const Branch& root : roots) descend(target, root, exclusion, limit, best);
  return best;
}

/// The median step between the two grounds where both were seen.
double ground_step_m(const BirdView& target, const BirdView& source, const TurnAndShift& T) {
  std::vector<float> steps;
  const auto c = static_cast<float>(std::cos(T.yaw_rad));
  const auto s = static_cast<float>(std::sin(T.yaw_rad));
  constexpr float kReach_m = 20.0F;
  for (float x = -kReach_m; x <= kReach_m; x += 1.0F) {
    for (float y = -kReach_m; y <= kReach_m; y += 1.0F) {
      const Eigen::Vector2f there{c * x - s * y + static_cast<float>(T.x_m), s * x + c * y + static_cast<float>(T.y_m)};
      const float step = target.ground_m(there) - source.ground_m({x, y});
      if (std::isfinite(step)) steps.push_back(step);
    }
  }
  if (steps.empty()) return 0.0;
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

}  // namespace

BirdView::BirdView(const Submap& submap) : ground_m_(kSize * kSize, std::numeric_limits<float>::quiet_NaN()) {
  std::vector<float> top_m(kSize * kSize, -std::numeric_limits<float>::infinity());
  for (const Eigen::Vector3f& p : submap.points) {
    const int ix = index(p.x());
    const int iy = index(p.y());
    if (!inside(ix, iy)) continue;
    top_m[flat(ix, iy)] = std::max(top_m[flat(ix, iy)], p.z());
    ground_m_[flat(ix, iy)] = std::fmin(ground_m_[flat(ix, iy)], p.z());
  }
  levels_[0].assign(kSize * kSize, 0);
  std::vector<Eigen::Vector2f> standing;
  for (int iy = 1; iy < kSize - 1; ++iy) {
    for (int ix = 1; ix < kSize - 1; ++ix) {
      if (!(top_m[flat(ix, iy)] - ground_m_[flat(ix, iy)] > kMinSpread_m)) continue;
      const auto middle = [](int i) { return (static_cast<float>(i - kSize / 2) + 0.5F) * kCell_m; };
      standing.emplace_back(middle(ix), middle(iy));
      for (const auto& [dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        std::uint8_t& beside = levels_[0][flat(ix + dx, iy + dy)];
        beside = std::max<std::uint8_t>(beside, 1);
      }
      levels_[0][flat(ix, iy)] = 2;
    }
  }
  const std::size_t stride = standing.size() / kMaxCells + 1;
  for (std::size_t i = 0; i < standing.size(); i += stride) cells_.push_back(standing[i]);
  for (int level = 1; level < kLevels; ++level) pool(level);
}

void BirdView::pool(int level) {
  const int half = 1 << (level - 1);
  levels_[level].assign(kSize * kSize, 0);
  for (int iy = 0; iy < kSize; ++iy) {
    for (int ix = 0; ix < kSize; ++ix) {
      levels_[level][flat(ix, iy)] = std::max({at(level - 1, ix, iy), at(level - 1, ix + half, iy),
                                               at(level - 1, ix, iy + half), at(level - 1, ix + half, iy + half)});
    }
  }
}

std::uint8_t BirdView::at(int level, int ix, int iy) const {
  if (ix >= kSize || iy >= kSize) return 0;
  // A square that begins outside and reaches in is not stored: its bound is taken as full.
  if (ix < 0 || iy < 0) return ix > -(1 << level) && iy > -(1 << level) ? 2 : 0;
  return levels_[level][flat(ix, iy)];
}

float BirdView::ground_m(const Eigen::Vector2f& p) const {
  const int ix = index(p.x());
  const int iy = index(p.y());
  return inside(ix, iy) ? ground_m_[flat(ix, iy)] : std::numeric_limits<float>::quiet_NaN();
}

PlanarMatch search(const BirdView& target, const BirdView& source, const TurnAndShift& guess, const PlanarWindow& window) {
  PlanarMatch result{.T_target_source = guess};
  if (source.cells().empty()) return result;
  const int limit = static_cast<int>(std::ceil(window.distance_m / BirdView::kCell_m));
  const std::vector<TurnedCells> turns = turn(source, guess, window.yaw_rad);
  const std::vector<Branch> tops = roots(target, turns, limit);
  const Branch best = best_leaf(target, tops, limit, {});
  if (best.turned == nullptr) return result;
  const int apart = static_cast<int>(PlanarMatch::kApart_m / BirdView::kCell_m);
  const Branch second = best_leaf(target, tops, limit, {best.dx, best.dy, apart});
  const double full = 2.0 * static_cast<double>(source.cells().size());
  result.T_target_source = {guess.x_m + best.dx * BirdView::kCell_m, guess.y_m + best.dy * BirdView::kCell_m,
                            best.turned->yaw_rad};
  result.score = best.bound / full;
  result.runner_up = second.bound / full;
  result.height_m = ground_step_m(target, source, result.T_target_source);
  return result;
}

}  // namespace slamd
