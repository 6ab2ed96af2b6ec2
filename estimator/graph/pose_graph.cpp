#include "estimator/graph/pose_graph.hpp"

#include "estimator/graph/disjoint_sets.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"

namespace slamd {

template <class Group>
std::size_t anchor_parts(PoseGraph<Group>& graph) {
  DisjointSets parts{graph.poses.size()};
  for (const Edge<Group>& edge : graph.edges) parts.join(edge.from, edge.to);
  std::vector<bool> anchored(graph.poses.size(), false);
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    if (graph.fixed[i]) anchored[parts.root(i)] = true;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    if (anchored[parts.root(i)]) continue;
    anchored[parts.root(i)] = graph.fixed[i] = true;
    ++count;
  }
  return count;
}

template <class Group>
ceres::Problem::Options GraphProblem<Group>::options() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

template <class Group>
GraphProblem<Group>::GraphProblem(const std::vector<typename Group::Element>& poses, const std::vector<bool>& fixed)
    : blocks_(poses.size()), problem_{options()} {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Group::store(poses[i], block(i));
    problem_.AddParameterBlock(block(i), Group::kSize, &manifold_);
    if (fixed[i]) problem_.SetParameterBlockConstant(block(i));
  }
}

template <class Group>
ceres::ResidualBlockId GraphProblem<Group>::add(const Edge<Group>& edge, RotationError kind, ceres::LossFunction* loss) {
  auto* factor = new BetweenFactor<Group>{edge.measured, square_root(edge.information), kind};  // the problem owns it
  return problem_.AddResidualBlock(factor, loss, block(edge.from), block(edge.to));
}

template <class Group>
void GraphProblem<Group>::copy_to(std::vector<typename Group::Element>& poses) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i) poses[i] = pose(i);
}

template <class Group>
SolveOutcome solve(PoseGraph<Group>& graph, const SolveLimits& limits) {
  GraphProblem<Group> problem{graph.poses, graph.fixed};
  for (const Edge<Group>& edge : graph.edges) problem.add(edge, graph.rotation_error);
  const SolveOutcome outcome = minimise(problem.problem(), limits);
  problem.copy_to(graph.poses);
  return outcome;
}

template std::size_t anchor_parts(PoseGraph<GroupSe2>&);
template std::size_t anchor_parts(PoseGraph<GroupSe3>&);
template SolveOutcome solve(PoseGraph<GroupSe2>&, const SolveLimits&);
template SolveOutcome solve(PoseGraph<GroupSe3>&, const SolveLimits&);
template class GraphProblem<GroupSe2>;
template class GraphProblem<GroupSe3>;

}  // namespace slamd
