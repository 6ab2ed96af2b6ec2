#include "estimator/graph/closure_consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>

namespace slamd {

namespace {

using Nodes = std::vector<std::size_t>;

double distance2(const RelativePose& ring) {
  const Vector6d e = boxminus(ring.T_a_b, Pose{});
  return e.dot(ring.covariance.ldlt().solve(e));
}

RelativePose measured(const LoopClosure& closure) { return {closure.T_from_to, closure.covariance}; }

/// A clique larger than one already known, by branch and bound with greedy colours as the bound.
/// Source: Tomita, Seki, "An efficient branch-and-bound algorithm for finding a maximum clique" (2003).
struct CliqueSearch {
  const std::vector<std::vector<bool>>& neighbours;
  std::size_t to_beat;
  std::uint32_t steps_left = AgreementGraph::kMaxSteps;
  Nodes clique{};
  Nodes best{};

  /// Colours of `nodes` such that neighbours differ: a clique in nodes[0..i] has at most colours[i] members. Reorders.
  std::vector<std::size_t> colour(Nodes& nodes) const {
    std::vector<Nodes> classes;
    for (const std::size_t node : nodes) {
      auto found = std::ranges::find_if(classes, [&](const Nodes& members) {
        return std::ranges::none_of(members, [&](std::size_t member) { return neighbours[node][member]; });
      });
      if (found == classes.end()) found = classes.insert(classes.end(), Nodes{});
      found->push_back(node);
    }
    nodes.clear();
    std::vector<std::size_t> colours;
    for (std::size_t c = 0; c < classes.size(); ++c) {
      nodes.insert(nodes.end(), classes[c].begin(), classes[c].end());
      colours.insert(colours.end(), classes[c].size(), c + 1);
    }
    return colours;
  }

  void expand(Nodes nodes) {
    const std::vector<std::size_t> colours = colour(nodes);
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (steps_left == 0 || clique.size() + colours[i] <= to_beat) return;
      --steps_left;
      clique.push_back(nodes[i]);
      if (clique.size() > to_beat) {
        best = clique;
        to_beat = clique.size();
      }
      Nodes below;
      std::copy_if(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(i), std::back_inserter(below),
                   [&](std::size_t node) { return neighbours[nodes[i]][node]; });
      expand(std::move(below));
      clique.pop_back();
    }
  }
};

}  // namespace

RelativePose odometry_between(const OdometryChain& chain, std::size_t i, std::size_t j) {
  return {chain.relative(i, j), chain.relative_covariance(i, j)};
}

double odometry_distance2(const OdometryChain& chain, const LoopClosure& closure) {
  return distance2(measured(closure) * odometry_between(chain, closure.to, closure.from));
}

double ring_distance2(const OdometryChain& chain, const LoopClosure& closure, const LoopClosure& other) {
  return distance2(measured(closure) * odometry_between(chain, closure.to, other.to) * measured(other).inverse() *
                   odometry_between(chain, other.from, closure.from));
}

void AgreementGraph::add(const std::vector<std::size_t>& agrees_with) {
  const std::size_t node = size();
  neighbours_.emplace_back(node + 1, false);
  for (std::vector<bool>& row : neighbours_) row.resize(node + 1, false);
  for (const std::size_t other : agrees_with) neighbours_[node][other] = neighbours_[other][node] = true;
  // One node more makes the largest clique larger by one at most.
  if (std::ranges::all_of(clique_, [&](std::size_t member) { return neighbours_[node][member]; })) {
    clique_.push_back(node);
    return;
  }
  CliqueSearch search{.neighbours = neighbours_, .to_beat = clique_.size(), .clique = {node}};
  search.expand(agrees_with);
  if (!search.best.empty()) clique_ = search.best;
}

}  // namespace slamd
