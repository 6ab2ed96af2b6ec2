#include "estimator/graph/gnc.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "estimator/graph/chordal.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/loop_support.hpp"
#include "estimator/graph/robust_loss.hpp"

namespace slamd {
namespace {

/// The weight of a squared error under the truncated quadratic of sharpness mu, eq. (14).
double tls_weight(double chi2, double limit, double mu) {
  if (chi2 <= mu / (mu + 1.0) * limit) return 1.0;
  if (chi2 >= (mu + 1.0) / mu * limit) return 0.0;
  return std::sqrt(limit / chi2 * mu * (mu + 1.0)) - mu;
}

/// The standard normal's value that is exceeded with probability p, by bisection.
double normal_quantile(double p) {
  double low = -40.0;
  double high = 40.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::sqrt(2.0)) > p ? low : high) = middle;
  }
  return low;
}

template <class Group>
class Gnc {
 public:
  Gnc(PoseGraph<Group>& graph, const std::vector<bool>& suspect, const GncConfig& config)
      : graph_{graph}, suspect_{suspect}, config_{config}, weights_(graph.edges.size(), 1.0) {}

  RobustOutcome run(const SolveLimits& limits) {
    const std::vector<bool> supported = supported_edges(graph_, suspect_);
    for (std::size_t k = 0; k < weights_.size(); ++k) weights_[k] = supported[k] ? 1.0 : 0.0;
    RobustOutcome outcome;
    outcome.solve = move_from_start(limits);
    if (!outcome.solve.usable) return outcome;
    SolveLimits round = limits;
    round.max_iterations = config_.iterations_a_round;
    lower_limit();
    for (double mu = config_.first_sharpness; outcome.rounds < config_.max_rounds; mu *= config_.sharpening) {
      if (limits.cancelled && limits.cancelled()) break;
      ++outcome.rounds;
      const bool settled = weigh(mu);
      outcome.solve = move(settled ? limits : round);
      if (!settled) continue;
      if (!lower_limit()) break;
      mu = config_.first_sharpness;
    }
    outcome.solve = give_second_chance(limits);
    outcome.weights = weights_;
    return outcome;
  }

 private:
  /// Edges of weight 0 are left out altogether: wrong ones join far ends of the drive, and the factorisation would fill up.
  SolveOutcome move(const SolveLimits& limits) {
    std::deque<WeightLoss> losses;
    GraphProblem<Group> problem{graph_.poses, graph_.fixed};
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (weights_[k] == 0.0) continue;
      WeightLoss* const loss = weights_[k] < 1.0 ? &losses.emplace_back(&weights_[k]) : nullptr;
      problem.add(graph_.edges[k], graph_.rotation_error, loss);
    }
    const SolveOutcome outcome = minimise(problem.problem(), limits);
    problem.copy_to(graph_.poses);
    return outcome;
  }

  /// How large errors are against what their information promises (files whose information is too small by far are
  /// common), at most 1: the median of kept loops, which wrong ones among them do not move, times the share of the error
  /// that the chain between takes over.
  double noise_scale() const {
    std::vector<double> loops;
    double of_loops = 0.0;
    double of_all = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (weights_[k] < 0.5) continue;
      const double error = chi2(graph_, graph_.edges[k]);
      of_all += error;
      if (!suspect_[k]) continue;
      of_loops += error;
      loops.push_back(error);
    }
    if (loops.empty() || of_loops <= 0.0) return 1.0;
    const auto middle = loops.begin() + static_cast<std::ptrdiff_t>(loops.size() / 2);
    std::nth_element(loops.begin(), middle, loops.end());
    return std::min(1.0, *middle / chi2_quantile(Group::kDof, 0.5) * of_all / of_loops);
  }

  /// Smaller than before, never larger: what was found wrong does not come back by making all others look worse.
  /// False when it is the same, nearly.
  bool lower_limit() {
    const double promised = chi2_quantile(Group::kDof, config_.outlier_probability);
    const double limit = promised * std::min(config_.noise_margin * noise_scale(), config_.information_margin);
    if (limit > 0.9 * limit_) return false;
    limit_ = limit;
    return true;
  }

  /// A right edge that alone joins what drifted apart looks wrong until it is in: near ones are taken in together, and stay
  /// when the rest can agree with them; then edges within the limit are taken until nothing changes.
  SolveOutcome give_second_chance(const SolveLimits& limits) {
    const std::vector<double> kept = weights_;
    keep_within(config_.second_chance * limit_);
    move_from_start(limits);
    keep_within(limit_);
    for (std::size_t k = 0; k < weights_.size(); ++k) weights_[k] = std::max(weights_[k], kept[k]);
    SolveOutcome outcome = move_from_start(limits);
    for (int i = 0; i < config_.last_rounds && keep_within(limit_); ++i) outcome = move_from_start(limits);
    return outcome;
  }

  SolveOutcome move_from_start(const SolveLimits& limits) {
    return initialise_chordal(graph_, weights_) ? move(limits) : SolveOutcome{};
  }

  /// True when another set is kept than before.
  bool keep_within(double limit) {
    const std::vector<double> before = weights_;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (suspect_[k]) weights_[k] = chi2(graph_, graph_.edges[k]) < limit ? 1.0 : 0.0;
    }
    return weights_ != before;
  }

  /// New weights; true when every edge is either kept or dropped.
  bool weigh(double mu) {
    bool settled = true;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (!suspect_[k]) continue;
      weights_[k] = tls_weight(chi2(graph_, graph_.edges[k]), limit_, mu);
      settled = settled && (weights_[k] == 0.0 || weights_[k] == 1.0);
    }
    return settled;
  }

  PoseGraph<Group>& graph_;
  const std::vector<bool>& suspect_;
  const GncConfig config_;
  double limit_ = std::numeric_limits<double>::infinity();  // chi2 from which on an edge is wrong
  std::vector<double> weights_;
};

}  // namespace

double chi2_quantile(int degrees_of_freedom, double exceeding_probability) {
  const double n = degrees_of_freedom;
  const double cube_root = 1.0 - 2.0 / (9.0 * n) + normal_quantile(exceeding_probability) * std::sqrt(2.0 / (9.0 * n));
  return n * cube_root * cube_root * cube_root;
}

template <class Group>
RobustOutcome solve_robustly(PoseGraph<Group>& graph, const std::vector<bool>& suspect, const GncConfig& config,
                             const SolveLimits& limits) {
  return Gnc<Group>{graph, suspect, config}.run(limits);
}

template RobustOutcome solve_robustly(PoseGraph<GroupSe2>&, const std::vector<bool>&, const GncConfig&,
                                      const SolveLimits&);
template RobustOutcome solve_robustly(PoseGraph<GroupSe3>&, const std::vector<bool>&, const GncConfig&,
                                      const SolveLimits&);

}  // namespace slamd
