#pragma once
// Which closures can all be true at once: two agree when the ring through both and odometry closes within its covariance;
// the largest set that agrees pairwise is believed. No graph is solved.
// Source: Mangelson et al., "Pairwise Consistent Measurement Set Maximization" (2018), eq. (4), (10).

#include <cstdint>
#include <vector>

#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/odometry_chain.hpp"
#include "estimator/graph/relative_pose.hpp"

namespace slamd {

/// Odometry from keyframe i to keyframe j, in either direction.
RelativePose odometry_between(const OdometryChain& chain, std::size_t i, std::size_t j);

/// Squared Mahalanobis distance, 6 degrees of freedom, between a closure and odometry's word on the same pair.
double odometry_distance2(const OdometryChain& chain, const LoopClosure& closure);

/// The same of the ring from -> to -> other.to -> other.from -> from.
double ring_distance2(const OdometryChain& chain, const LoopClosure& closure, const LoopClosure& other);

/// Who agrees with whom, and the largest set of nodes that all agree, node by node.
class AgreementGraph {
 public:
  /// Adds a node that agrees with those listed (indices below size()). The set changes when a larger one appears: of
  /// equal ones the older stays. Exact unless the search is cut off after kMaxSteps branches.
  void add(const std::vector<std::size_t>& agrees_with);
  std::size_t size() const { return neighbours_.size(); }
  /// In no order.
  const std::vector<std::size_t>& largest_clique() const { return clique_; }

  static constexpr std::uint32_t kMaxSteps = 20'000;

 private:
  std::vector<std::vector<bool>> neighbours_;
  std::vector<std::size_t> clique_;
};

}  // namespace slamd
