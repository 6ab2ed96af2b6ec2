#include "estimator/graph/loop_consensus.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "estimator/graph/edge_covariance.hpp"
#include "estimator/graph/gnc.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/loop_support.hpp"

namespace slamd {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::array<std::size_t, 5> kGroups{16, 8, 4, 2, 1};  // suspects that agree, at least: ranks
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

double median(std::vector<double> values) {
  if (values.empty()) return 1.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return std::max(*middle, std::numeric_limits<double>::min());
}

template <class Group>
class Consensus {
 public:
  Consensus(const PoseGraph<Group>& graph, const std::vector<bool>& suspect, const LoopConsensusConfig& config)
      : graph_{graph}, suspect_{suspect}, config_{config}, groups_{supporting_groups(graph, suspect)},
        distance_(graph.poses.size(), kFar),
        arrived_by_(graph.poses.size(), kNone) {
    for (const Edge<Group>& edge : graph.edges) covariance_.push_back(covariance_of(edge.information));
    measure_steps(suspect);
  }

  /// Errors may be far smaller than their information promises: judged by what it promises wrong edges pass, but right ones
  /// are more, and tell how large errors are.
  std::vector<bool> run(const std::function<bool()>& cancelled) {
    const double promised = chi2_quantile(Group::kDof, config_.outlier_probability);
    for (double scale = 1.0;;) {
      limit_ = promised * std::min(1.0, config_.noise_margin * scale);
      judge_all(cancelled);
      const double found = median(errors_) / chi2_quantile(Group::kDof, 0.5);
      if ((cancelled && cancelled()) || config_.noise_margin * found > 0.5 * std::min(1.0, config_.noise_margin * scale)) return believed_;
      scale = found;
    }
  }

 private:
  void judge_all(const std::function<bool()>& cancelled) {
    believed_.assign(graph_.edges.size(), false);
    joined_.assign(graph_.poses.size(), {});
    errors_.clear();
    for (std::vector<std::vector<std::size_t>>& waiting : waiting_) waiting.assign(graph_.poses.size(), {});
    for (std::size_t k = 0; k < suspect_.size(); ++k) {
      const Edge<Group>& edge = graph_.edges[k];
      if (suspect_[k]) waiting_[rank_of(groups_[k])][std::max(edge.from, edge.to)].push_back(k);
      else believe(k);
    }
    const double longest = std::accumulate(length_.begin(), length_.end(), 0.0) * config_.shorter_alone;
    for (double reach = config_.first_reach; reach < config_.reach_growth * longest; reach *= config_.reach_growth) {
      while (judge_ranks(reach)) {
      }
      if (left_ == 0 || (cancelled && cancelled())) return;
    }
  }

  static std::size_t rank_of(std::size_t group) {
    return static_cast<std::size_t>(std::ranges::find_if(kGroups, [&](std::size_t least) { return group >= least; }) - kGroups.begin());
  }

  /// What many others confirm may close a longer ring than small groups and what stands alone. True when any was believed.
  bool judge_ranks(double reach) {
    bool any = false;
    left_ = 0;
    for (std::size_t rank = 0; rank < kGroups.size(); ++rank) {
      const double share = std::pow(config_.shorter_alone, static_cast<double>(rank) / static_cast<double>(kGroups.size() - 1));
      any = judge(waiting_[rank], reach / share) || any;
    }
    return any;
  }

  /// Lengths in steps: what an edge does not know, against what a step of odometry does not.
  void measure_steps(const std::vector<bool>& suspect) {
    constexpr int d = Group::kDimension;
    std::vector<double> shifts, turns;
    for (std::size_t k = 0; k < suspect.size(); ++k) {
      if (suspect[k]) continue;
      shifts.push_back(covariance_[k].diagonal().template head<d>().sum());
      turns.push_back(covariance_[k].diagonal().template tail<Group::kDof - d>().sum());
    }
    const double shift = median(std::move(shifts)), turn = median(std::move(turns));
    for (const typename Group::Matrix& c : covariance_) {
      length_.push_back(0.5 * (c.diagonal().template head<d>().sum() / shift +
                               c.diagonal().template tail<Group::kDof - d>().sum() / turn));
    }
  }

  void believe(std::size_t edge) {
    believed_[edge] = true;
    joined_[graph_.edges[edge].from].push_back(edge);
    joined_[graph_.edges[edge].to].push_back(edge);
  }

  /// Every waiting edge that a way within reach leads round; those that fit are believed from then on. True when some were.
  bool judge(std::vector<std::vector<std::size_t>>& waiting, double reach) {
    std::vector<std::size_t> fitting;
    for (std::size_t from = 0; from < waiting.size(); ++from) {
      std::vector<std::size_t>& edges = waiting[from];
      if (edges.empty()) continue;
      search(from, reach);
      std::erase_if(edges, [&](std::size_t k) {
        const std::size_t to = graph_.edges[k].from == from ? graph_.edges[k].to : graph_.edges[k].from;
        if (distance_[to] == kFar) return false;
        const double error = chi2_of_ring(k, from, to);
        if (error < limit_) {
          fitting.push_back(k);
          errors_.push_back(error);
        }
        return true;
      });
      left_ += edges.size();
      for (const std::size_t pose : reached_) distance_[pose] = kFar;
    }
    for (const std::size_t k : fitting) believe(k);
    return !fitting.empty();
  }

  /// Dijkstra's search from a pose over believed edges, as far as reach.
  void search(std::size_t from, double reach) {
    using Stop = std::pair<double, std::size_t>;
    std::priority_queue<Stop, std::vector<Stop>, std::greater<>> open;
    reached_.clear();
    const auto arrive = [&](std::size_t pose, double distance, std::size_t edge) {
      if (distance > reach || distance >= distance_[pose]) return;
      if (distance_[pose] == kFar) reached_.push_back(pose);
      distance_[pose] = distance;
      arrived_by_[pose] = edge;
      open.emplace(distance, pose);
    };
    arrive(from, 0.0, kNone);
    while (!open.empty()) {
      const auto [distance, pose] = open.top();
      open.pop();
      if (distance > distance_[pose]) continue;
      for (const std::size_t k : joined_[pose]) arrive(other_end(k, pose), distance + length_[k], k);
    }
  }

  std::size_t other_end(std::size_t edge, std::size_t pose) const {
    return graph_.edges[edge].from == pose ? graph_.edges[edge].to : graph_.edges[edge].from;
  }

  /// What the edge and the way that was found say differently.
  double chi2_of_ring(std::size_t edge, std::size_t from, std::size_t to) const {
    typename Group::Element T_pose_to{};
    typename Group::Matrix way = Group::Matrix::Zero();  // of T_pose_to, perturbed on its right
    for (std::size_t pose = to; pose != from;) {
      const std::size_t k = arrived_by_[pose];
      const std::size_t before = other_end(k, pose);
      const bool forward = graph_.edges[k].from == before;
      const typename Group::Element T_before_pose = forward ? graph_.edges[k].measured : graph_.edges[k].measured.inverse();
      const typename Group::Matrix A = carried(T_pose_to.inverse());
      const typename Group::Matrix B = forward ? A : A * carried(graph_.edges[k].measured);
      way += B * covariance_[k] * B.transpose();
      T_pose_to = T_before_pose * T_pose_to;
      pose = before;
    }
    const bool forward = graph_.edges[edge].from == from;
    const typename Group::Element& measured = graph_.edges[edge].measured;
    const typename Group::Tangent e = forward ? Group::minus(T_pose_to, measured) : Group::minus(T_pose_to.inverse(), measured);
    const typename Group::Matrix C = carried(T_pose_to);
    const typename Group::Matrix seen = forward ? way : C * way * C.transpose();
    return e.dot((seen + covariance_[edge]).llt().solve(e));
  }

  /// The adjoint: Exp(adjoint e) T = T Exp(e), so a perturbation on the left of T as one on its right is carried(T^-1).
  static typename Group::Matrix carried(const typename Group::Element& T) {
    typename Group::Matrix J;
    const typename Group::Element T_inverse = T.inverse();
    Group::between_error({}, T_inverse, T_inverse, RotationError::kLog, &J, nullptr);
    return -J;
  }

  const PoseGraph<Group>& graph_;
  const std::vector<bool>& suspect_;
  const LoopConsensusConfig config_;
  const std::vector<std::size_t> groups_;          // how many suspects agree with each
  double limit_ = 0.0;
  std::vector<double> errors_;                     // of the suspects that are believed, as they were judged
  std::vector<bool> believed_;
  std::vector<std::vector<std::size_t>> joined_;   // believed edges at each pose
  std::array<std::vector<std::vector<std::size_t>>, kGroups.size()> waiting_;  // by rank: not judged yet, at their later pose
  std::vector<double> distance_;                   // of the last search
  std::vector<std::size_t> arrived_by_;
  std::vector<std::size_t> reached_;
  std::vector<typename Group::Matrix> covariance_;
  std::vector<double> length_;
  std::size_t left_ = 0;
};

}  // namespace

template <class Group>
std::vector<bool> consenting_edges(const PoseGraph<Group>& graph, const std::vector<bool>& suspect,
                                   const LoopConsensusConfig& config, const std::function<bool()>& cancelled) {
  return Consensus<Group>{graph, suspect, config}.run(cancelled);
}

template std::vector<bool> consenting_edges(const PoseGraph<GroupSe2>&, const std::vector<bool>&, const LoopConsensusConfig&,
                                            const std::function<bool()>&);
template std::vector<bool> consenting_edges(const PoseGraph<GroupSe3>&, const std::vector<bool>&, const LoopConsensusConfig&,
                                            const std::function<bool()>&);

}  // namespace slamd
