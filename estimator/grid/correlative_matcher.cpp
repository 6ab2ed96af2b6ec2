#include "estimator/grid/correlative_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace slamd {
namespace {

/// The smallest square of a number in [low, high].
double least_square(double low, double high) {
  const double nearest = std::clamp(0.0, low, high);
  return nearest * nearest;
}

}  // namespace

double CorrelativeMatcher::yaw_step(std::span<const Eigen::Vector2f> points, double cell_m) {
  float farthest2 = 1.0F;
  for (const Eigen::Vector2f& point : points) farthest2 = std::max(farthest2, point.squaredNorm());
  return cell_m / std::sqrt(static_cast<double>(farthest2));
}

void CorrelativeMatcher::rotate(const LikelihoodPyramid& likelihood, std::span<const Eigen::Vector2f> points,
                                const SearchWindow& window) {
  likelihood_ = &likelihood;
  count_ = points.size();
  yaw_step_rad_ = yaw_step(points, likelihood.cell_m());
  half_yaws_ = static_cast<int>(std::ceil(window.half_yaw_rad / yaw_step_rad_));
  half_cells_ = static_cast<int>(std::ceil(window.half_width_m / likelihood.cell_m()));
  centre_share_ = window.centre_share;
  cells_.clear();
  for (int yaw = -half_yaws_; yaw <= half_yaws_; ++yaw) {
    const PlanarPose T{window.centre.translation, window.centre.yaw_rad + yaw * yaw_step_rad_};
    const Eigen::Matrix2d R = T.rotation();
    for (const Eigen::Vector2f& point : points) {
      const Eigen::Vector2d p = (R * point.cast<double>() + T.translation) / likelihood.cell_m();
      cells_.push_back({static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))});
    }
  }
}

double CorrelativeMatcher::value_bound(const Node& node) {
  --looks_left_;
  std::uint32_t sum = 0;
  const Eigen::Vector2i shift{node.x, node.y};
  for (const Eigen::Vector2i& cell : rotated(node.yaw)) sum += likelihood_->bound(node.level, cell + shift);
  const int side = (1 << node.level) - 1;
  const double width = std::max(half_cells_, 1);
  const double angle = static_cast<double>(node.yaw) / std::max(half_yaws_, 1);
  const double away = 0.5 * (least_square(node.x, node.x + side) + least_square(node.y, node.y + side)) / (width * width);
  return sum / (255.0 * static_cast<double>(count_)) - centre_share_ * 0.5 * (away + angle * angle);
}

/// Depth first, the most promising first, what cannot beat the best is left out.
void CorrelativeMatcher::descend(std::vector<Node>& nodes) {
  const auto order = [](const Node& a, const Node& b) {
    return std::tuple{-a.bound, std::abs(a.yaw), a.yaw, a.x, a.y} < std::tuple{-b.bound, std::abs(b.yaw), b.yaw, b.x, b.y};
  };
  std::ranges::sort(nodes, order);
  for (const Node& node : nodes) {
    if (node.bound <= best_.bound || looks_left_ <= 0) return;
    if (node.level == 0) {
      best_ = node;
      return;
    }
    std::vector<Node> halves;
    const int half = 1 << (node.level - 1);
    for (const int y : {node.y, node.y + half}) {
      for (const int x : {node.x, node.x + half}) {
        if (x > half_cells_ || y > half_cells_) continue;
        Node part{node.yaw, x, y, node.level - 1, 0.0};
        part.bound = value_bound(part);
        if (part.bound > best_.bound) halves.push_back(part);
      }
    }
    descend(halves);
  }
}

std::optional<CorrelativeMatch> CorrelativeMatcher::match(const LikelihoodPyramid& likelihood,
                                                          std::span<const Eigen::Vector2f> points, const SearchWindow& window) {
  if (points.empty()) return std::nullopt;
  rotate(likelihood, points, window);
  int top = 0;
  while (top + 1 < likelihood.levels() && (1 << top) <= half_cells_) ++top;
  looks_left_ = window.most_looks;
  best_ = {0, 0, 0, -1, std::max(window.least_score, 1e-9)};
  std::vector<Node> roots;
  for (int yaw = -half_yaws_; yaw <= half_yaws_ && looks_left_ > 0; ++yaw) {
    for (int y = -half_cells_; y <= half_cells_; y += 1 << top) {
      for (int x = -half_cells_; x <= half_cells_; x += 1 << top) {
        roots.push_back({yaw, x, y, top, 0.0});
        roots.back().bound = value_bound(roots.back());
      }
    }
  }
  descend(roots);
  if (best_.level < 0) return std::nullopt;
  CorrelativeMatch found;
  const Eigen::Vector2d shift = Eigen::Vector2d{best_.x, best_.y} * likelihood.cell_m();
  found.T_map_base = {window.centre.translation + shift, window.centre.yaw_rad + best_.yaw * yaw_step_rad_};
  found.value = best_.bound;
  found.exact = looks_left_ > 0;
  centre_share_ = 0.0;
  found.score = value_bound(best_);
  return found;
}

}  // namespace slamd
