#include "estimator/graph/map_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "estimator/graph/gnss_factor.hpp"
#include "estimator/graph/gravity_factor.hpp"
#include "estimator/graph/marginal.hpp"
#include "estimator/graph/robust_loss.hpp"

namespace slamd {
namespace {

// The first keyframe holds the whole map: place and heading are free to choose, its tilt is for gravity to say.
constexpr double kAnchorPosition_m = 1e-3;
constexpr double kAnchorTilt_rad = 0.3;  // of the first pose: next to nothing, for it is gravity that levels
constexpr double kAnchorYaw_rad = 1e-4;
// No step of odometry is surer than that: information stays finite where the filter says zero.
constexpr double kLeastSigma_m = 1e-4;
constexpr double kLeastSigma_rad = 1e-5;
// Closures no more keyframes apart than this, at both ends, share most of their sub-maps.
constexpr std::uint64_t kNeighbours = 8;
constexpr double kTightening = 4.0;  // of the closures' loss from one pass to the next

Matrix6d information_of(const Matrix6d& covariance) {
  Matrix6d floored = covariance;
  floored.diagonal().head<3>().array() += kLeastSigma_m * kLeastSigma_m;
  floored.diagonal().tail<3>().array() += kLeastSigma_rad * kLeastSigma_rad;
  Matrix6d information = floored.llt().solve(Matrix6d::Identity());
  symmetrise(information);
  return information;
}

/// How many closures have the error of this one, itself included.
double shared_by(std::span<const LoopClosure> closures, const LoopClosure& closure, const MapGraphConfig& config) {
  const auto near = [&](std::uint64_t a, std::uint64_t b) { return (a > b ? a - b : b - a) <= kNeighbours; };
  const auto count = std::ranges::count_if(
      closures, [&](const LoopClosure& other) { return near(other.from, closure.from) && near(other.to, closure.to); });
  return std::min(static_cast<double>(count), config.closure_correlation);
}

Matrix6d anchor_whitening() {
  Vector6d sigma;
  sigma << kAnchorPosition_m, kAnchorPosition_m, kAnchorPosition_m, kAnchorTilt_rad, kAnchorTilt_rad, kAnchorYaw_rad;
  return sigma.cwiseInverse().asDiagonal();
}

}  // namespace

/// The solver's side of one solve.
class MapGraph::Problem {
 public:
  Problem(const MapGraph& graph, const GraphConstraints& constraints)
      : closure_phi_{graph.config_.closure_phi},
        closure_loss_{graph.config_.closure_phi},
        position_loss_{graph.config_.position_phi},
        variables_{graph.poses_, std::vector<bool>(graph.poses_.size(), false)} {
    add_chain(graph);
    for (const LoopClosure& closure : constraints.closures) {
      const Matrix6d covariance = shared_by(constraints.closures, closure, graph.config_) * closure.covariance;
      const Edge<GroupSe3> edge{closure.from, closure.to, closure.T_from_to, information_of(covariance)};
      closures_.push_back(variables_.add(edge, RotationError::kLog, &closure_loss_));
    }
    if (!constraints.enu) return;
    EnuBlock::store(*constraints.enu, enu_.data());
    for (const GnssPosition& position : constraints.positions) {
      positions_.push_back(ceres().AddResidualBlock(new GnssFactor{position}, &position_loss_,
                                                    variables_.block(position.keyframe), enu_.data()));
    }
  }

  ceres::Problem& ceres() { return variables_.problem(); }

  /// A right closure at the end of a long drift begins with a large error, and its loss would give it up for that. So all
  /// count fully at first, and the loss tightens as the graph gives way (Yang et al. 2020, graduated non-convexity).
  SolveOutcome solve(const SolveLimits& limits) {
    int iterations = 0;
    for (double phi = std::max(closure_phi_, worst_closure());;) {
      closure_loss_.set_phi(phi);
      SolveOutcome outcome = minimise(ceres(), limits);
      outcome.iterations = iterations += outcome.iterations;
      if (phi <= closure_phi_ || !outcome.usable || outcome.cancelled) return outcome;
      phi = std::max(closure_phi_, std::min(phi / kTightening, worst_closure()));
    }
  }

  void copy_to(std::vector<Pose>& poses) const { variables_.copy_to(poses); }
  std::vector<double> closure_weights() { return weights(closures_, closure_loss_); }
  std::vector<double> position_weights() { return weights(positions_, position_loss_); }

  /// nullopt without positions.
  std::optional<EnuAlignment> enu() {
    if (positions_.empty()) return std::nullopt;
    EnuAlignment enu = EnuBlock::load(enu_.data());
    const Eigen::MatrixXd covariance = marginal_covariance(ceres(), enu_.data());
    if (covariance.rows() == EnuBlock::kSize) enu.covariance = covariance;
    return enu;
  }

 private:
  void add_chain(const MapGraph& graph) {
    ceres().AddResidualBlock(new PriorFactor<GroupSe3>{graph.anchor_, anchor_whitening()}, nullptr, variables_.block(0));
    for (const Edge<GroupSe3>& edge : graph.chain_) variables_.add(edge, RotationError::kLog);
    for (std::size_t i = 0; i < graph.nodes_.size(); ++i) {
      const Node& node = graph.nodes_[i];
      ceres().AddResidualBlock(new GravityFactor{node.up_base, node.up_sigma_rad}, nullptr, variables_.block(i));
    }
  }

  double chi2(ceres::ResidualBlockId id) {
    double cost = 0.0;
    ceres().EvaluateResidualBlock(id, false, &cost, nullptr, nullptr);
    return 2.0 * cost;
  }

  double worst_closure() {
    double worst = 0.0;
    for (const ceres::ResidualBlockId id : closures_) worst = std::max(worst, chi2(id));
    return worst;
  }

  std::vector<double> weights(const std::vector<ceres::ResidualBlockId>& ids, const DcsLoss& loss) {
    std::vector<double> weights;
    for (const ceres::ResidualBlockId id : ids) weights.push_back(loss.weight(chi2(id)));
    return weights;
  }

  double closure_phi_;
  DcsLoss closure_loss_, position_loss_;
  GraphProblem<GroupSe3> variables_;
  std::array<double, EnuBlock::kSize> enu_{};
  std::vector<ceres::ResidualBlockId> closures_, positions_;
};

void MapGraph::add(const Keyframe& keyframe) {
  const Pose& T_odom_base = keyframe.state.T_odom_base;
  if (poses_.empty()) {
    anchor_ = T_odom_base;
    poses_.push_back(T_odom_base);
  } else {
    const Pose T_previous_this = T_odom_newest_.inverse() * T_odom_base;
    const std::size_t previous = poses_.size() - 1;
    chain_.push_back({previous, previous + 1, T_previous_this, information_of(keyframe.relative_covariance)});
    poses_.push_back(poses_.back() * T_previous_this);
  }
  T_odom_newest_ = T_odom_base;
  nodes_.push_back({keyframe.up_base, gravity_sigma(keyframe.up_sigma_rad)});
}

/// What the filter has not learnt yet is one error that all keyframes until then share, and later ones tell it: counted as if
/// each knew a part of it, they bend the map wherever odometry is unsure.
double MapGraph::gravity_sigma(double told_rad) const {
  const double unlearnt = std::max(1.0, told_rad / config_.gravity_sigma_rad);
  return std::hypot(told_rad, config_.gravity_sigma_rad) * std::sqrt(config_.gravity_correlation) * unlearnt * unlearnt;
}

MapGraphSolve MapGraph::solve(const GraphConstraints& constraints, const SolveLimits& limits) {
  MapGraphSolve solve;
  if (poses_.empty()) return solve;
  Problem problem{*this, constraints};
  solve.outcome = problem.solve(limits);
  if (!solve.outcome.usable) return solve;
  problem.copy_to(poses_);
  solve.closure_weights = problem.closure_weights();
  solve.position_weights = problem.position_weights();
  if (!solve.outcome.cancelled) solve.enu = problem.enu();
  return solve;
}

}  // namespace slamd
