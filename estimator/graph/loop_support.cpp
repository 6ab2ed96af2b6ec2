#include "estimator/graph/loop_support.hpp"

#include <Eigen/Cholesky>
#include <optional>
#include <unordered_map>

#include "estimator/graph/disjoint_sets.hpp"
#include "estimator/graph/edge_covariance.hpp"
#include "estimator/graph/gnc.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"

namespace slamd {
namespace {

template <class Group>
struct Step {
  typename Group::Element T;
  typename Group::Matrix covariance = Group::Matrix::Zero();
};

/// Odometry between poses that are near in the order of the drive.
template <class Group>
class Odometry {
 public:
  Odometry(const PoseGraph<Group>& graph, const std::vector<bool>& suspect) : steps_(graph.poses.size()) {
    for (std::size_t k = 0; k < graph.edges.size(); ++k) {
      const Edge<Group>& edge = graph.edges[k];
      if (suspect[k]) continue;
      if (edge.to == edge.from + 1) steps_[edge.from] = Step<Group>{edge.measured, covariance_of(edge.information)};
      if (edge.from == edge.to + 1) steps_[edge.to] = Step<Group>{edge.measured.inverse(), covariance_of(edge.information)};
    }
  }

  /// From pose a to pose b; nullopt where a step is missing.
  std::optional<Step<Group>> between(std::size_t a, std::size_t b) const {
    Step<Group> sum;
    for (std::size_t i = std::min(a, b); i < std::max(a, b); ++i) {
      if (!steps_[i]) return std::nullopt;
      sum.T = sum.T * steps_[i]->T;
      sum.covariance += steps_[i]->covariance;
    }
    if (a > b) sum.T = sum.T.inverse();
    return sum;
  }

 private:
  std::vector<std::optional<Step<Group>>> steps_;
};

/// A suspect edge, its earlier pose first.
template <class Group>
struct Loop {
  std::size_t edge, early, late;
  Step<Group> step;
};

template <class Group>
Loop<Group> loop_of(const PoseGraph<Group>& graph, std::size_t k) {
  const Edge<Group>& edge = graph.edges[k];
  const bool forward = edge.from < edge.to;
  return {k, std::min(edge.from, edge.to), std::max(edge.from, edge.to),
          {forward ? edge.measured : edge.measured.inverse(), covariance_of(edge.information)}};
}

template <class Group>
bool agree(const Odometry<Group>& odometry, const Loop<Group>& a, const Loop<Group>& b, double limit) {
  const auto early = odometry.between(b.early, a.early);
  const auto late = odometry.between(a.late, b.late);
  if (!early || !late) return false;
  const typename Group::Tangent e = Group::minus(early->T * a.step.T * late->T, b.step.T);
  const typename Group::Matrix covariance = a.step.covariance + b.step.covariance + early->covariance + late->covariance;
  return e.dot(covariance.llt().solve(e)) < limit;
}

std::size_t distance(std::size_t a, std::size_t b) { return a > b ? a - b : b - a; }

}  // namespace

template <class Group>
std::vector<std::size_t> supporting_groups(const PoseGraph<Group>& graph, const std::vector<bool>& suspect,
                                           const LoopSupportConfig& config) {
  const Odometry<Group> odometry{graph, suspect};
  const double limit = chi2_quantile(Group::kDof, config.outlier_probability);
  const std::size_t cell = config.reach + 1;
  const std::size_t columns = graph.poses.size() / cell + 3;
  std::unordered_map<std::size_t, std::vector<Loop<Group>>> cells;  // by both ends, in units of `cell`
  DisjointSets groups{graph.edges.size()};
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    if (!suspect[k]) continue;
    const Loop<Group> loop = loop_of(graph, k);
    const std::size_t row = loop.early / cell + 1;
    const std::size_t column = loop.late / cell + 1;
    for (std::size_t r = row - 1; r <= row + 1; ++r) {
      for (std::size_t c = column - 1; c <= column + 1; ++c) {
        const auto found = cells.find(r * columns + c);
        if (found == cells.end()) continue;
        for (const Loop<Group>& other : found->second) {
          const bool near = distance(loop.early, other.early) <= config.reach && distance(loop.late, other.late) <= config.reach;
          if (near && agree(odometry, loop, other, limit)) groups.join(k, other.edge);
        }
      }
    }
    cells[row * columns + column].push_back(loop);
  }
  return groups.sizes();
}

template <class Group>
std::vector<bool> supported_edges(const PoseGraph<Group>& graph, const std::vector<bool>& suspect) {
  const std::vector<std::size_t> groups = supporting_groups(graph, suspect);
  std::vector<bool> supported;
  for (std::size_t k = 0; k < groups.size(); ++k) supported.push_back(!suspect[k] || groups[k] > 1);
  return supported;
}

template std::vector<std::size_t> supporting_groups(const PoseGraph<GroupSe2>&, const std::vector<bool>&, const LoopSupportConfig&);
template std::vector<std::size_t> supporting_groups(const PoseGraph<GroupSe3>&, const std::vector<bool>&, const LoopSupportConfig&);
template std::vector<bool> supported_edges(const PoseGraph<GroupSe2>&, const std::vector<bool>&);
template std::vector<bool> supported_edges(const PoseGraph<GroupSe3>&, const std::vector<bool>&);

}  // namespace slamd
