#include "estimator/graph/edge_costs.hpp"

#include <algorithm>

#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/loop_support.hpp"
#include "estimator/graph/marginal.hpp"

namespace slamd {
namespace {

/// The kept edges as a graph of their own; places: where each was before.
template <class Group>
PoseGraph<Group> kept_part(const PoseGraph<Group>& graph, const std::vector<bool>& kept, std::vector<std::size_t>& places) {
  PoseGraph<Group> part{.poses = graph.poses, .fixed = graph.fixed, .edges = {}, .rotation_error = graph.rotation_error};
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (!kept[k]) continue;
    part.edges.push_back(graph.edges[k]);
    places.push_back(k);
  }
  return part;
}

template <class Group>
std::vector<ceres::ResidualBlockId> add_all(GraphProblem<Group>& problem, const PoseGraph<Group>& graph) {
  std::vector<ceres::ResidualBlockId> ids;
  for (const Edge<Group>& edge : graph.edges) ids.push_back(problem.add(edge, graph.rotation_error));
  return ids;
}

}  // namespace

template <class Group>
std::optional<LoneEdge> worst_lone_edge(const PoseGraph<Group>& graph, const std::vector<bool>& kept,
                                        const std::vector<bool>& suspect) {
  std::vector<std::size_t> places;
  const PoseGraph<Group> part = kept_part(graph, kept, places);
  std::vector<bool> suspect_here;
  for (const std::size_t k : places) suspect_here.push_back(suspect[k]);
  const std::vector<bool> confirmed = supported_edges(part, suspect_here);
  GraphProblem<Group> problem{part.poses, part.fixed};
  const std::vector<ceres::ResidualBlockId> solved = add_all(problem, part);
  std::vector<std::size_t> lone;
  std::vector<ceres::ResidualBlockId> errors;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    if (confirmed[i]) continue;
    lone.push_back(places[i]);
    errors.push_back(solved[i]);
  }
  const std::vector<double> costs = error_costs(problem.problem(), solved, errors, ErrorsAre::kSolvedWith);
  if (costs.empty()) return std::nullopt;
  const auto worst = std::ranges::max_element(costs);
  return LoneEdge{lone[static_cast<std::size_t>(worst - costs.begin())], *worst};
}

template <class Group>
std::vector<double> costs_of_adding(const PoseGraph<Group>& graph, const std::vector<bool>& kept,
                                    const std::vector<std::size_t>& edges) {
  std::vector<std::size_t> places;
  const PoseGraph<Group> part = kept_part(graph, kept, places);
  GraphProblem<Group> problem{part.poses, part.fixed};
  const std::vector<ceres::ResidualBlockId> solved = add_all(problem, part);
  std::vector<ceres::ResidualBlockId> errors;
  for (const std::size_t k : edges) errors.push_back(problem.add(graph.edges[k], graph.rotation_error));
  return error_costs(problem.problem(), solved, errors, ErrorsAre::kLeftOut);
}

template std::optional<LoneEdge> worst_lone_edge(const PoseGraph<GroupSe2>&, const std::vector<bool>&, const std::vector<bool>&);
template std::optional<LoneEdge> worst_lone_edge(const PoseGraph<GroupSe3>&, const std::vector<bool>&, const std::vector<bool>&);
template std::vector<double> costs_of_adding(const PoseGraph<GroupSe2>&, const std::vector<bool>&, const std::vector<std::size_t>&);
template std::vector<double> costs_of_adding(const PoseGraph<GroupSe3>&, const std::vector<bool>&, const std::vector<std::size_t>&);

}  // namespace slamd
