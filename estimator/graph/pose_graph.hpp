#pragma once
// A graph of poses and measured edges between them, as a plain value, and the solver's problem made of it. Loops, GPS and
// gravity of the map are map_graph; files are tools/slam-pgo.

#include <ceres/problem.h>

#include <array>
#include <cstddef>
#include <vector>

#include "estimator/graph/between_factor.hpp"
#include "estimator/graph/manifold.hpp"
#include "estimator/graph/minimise.hpp"

namespace slamd {

/// measured: T_from_to; information of e with T_from_to = measured * Exp(e), rows as Group.
template <class Group>
struct Edge {
  std::size_t from = 0;
  std::size_t to = 0;
  typename Group::Element measured;
  typename Group::Matrix information = Group::Matrix::Identity();
};

template <class Group>
struct PoseGraph {
  std::vector<typename Group::Element> poses;
  std::vector<bool> fixed;  // one a pose: true = known, stays where it is
  std::vector<Edge<Group>> edges;
  RotationError rotation_error = RotationError::kLog;
};

/// e^T * information * e of one edge, where its poses lie now.
template <class Group>
double chi2(const PoseGraph<Group>& graph, const Edge<Group>& edge) {
  const typename Group::Tangent e = Group::between_error(graph.poses[edge.from], graph.poses[edge.to], edge.measured,
                                                         graph.rotation_error, nullptr, nullptr);
  return e.dot(edge.information * e);
}

/// The sum over all edges, without robust weights.
template <class Group>
double objective(const PoseGraph<Group>& graph) {
  double sum = 0.0;
  for (const Edge<Group>& edge : graph.edges) sum += chi2(graph, edge);
  return sum;
}

/// Fixes the first pose of each connected part that has no fixed one: without it the part floats. Returns how many.
template <class Group>
std::size_t anchor_parts(PoseGraph<Group>& graph);

/// The solver's side of a graph: owns the variables and the problem. Further factors may be added to both.
template <class Group>
class GraphProblem {
 public:
  GraphProblem(const std::vector<typename Group::Element>& poses, const std::vector<bool>& fixed);

  /// loss  null = squared; must outlive this
  ceres::ResidualBlockId add(const Edge<Group>& edge, RotationError kind, ceres::LossFunction* loss = nullptr);

  /// The variables of a pose, Group::kSize numbers; stays where it is.
  double* block(std::size_t pose) { return blocks_[pose].data(); }
  ceres::Problem& problem() { return problem_; }
  typename Group::Element pose(std::size_t i) const { return Group::load(blocks_[i].data()); }
  void copy_to(std::vector<typename Group::Element>& poses) const;

 private:
  static ceres::Problem::Options options();

  std::vector<std::array<double, Group::kSize>> blocks_;
  GroupManifold<Group> manifold_;
  ceres::Problem problem_;
};

/// Least squares over all edges from where the poses lie; moves graph.poses.
template <class Group>
SolveOutcome solve(PoseGraph<Group>& graph, const SolveLimits& limits);

}  // namespace slamd
