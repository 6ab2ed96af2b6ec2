#include "estimator/graph/gnc.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
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
      : graph_{graph},
        suspect_{suspect},
        config_{config},
        limit_{chi2_quantile(Group::kDof, config.outlier_probability)},
        weights_(graph.edges.size(), 1.0),
        problem_{graph.poses, graph.fixed} {
    for (std::size_t k = 0; k < graph.edges.size(); ++k) {
      WeightLoss* const loss = suspect[k] ? &losses_.emplace_back(&weights_[k]) : nullptr;
      problem_.add(graph.edges[k], graph.rotation_error, loss);
    }
  }

  RobustOutcome run(const SolveLimits& limits) {
    RobustOutcome outcome;
    SolveLimits round = limits;
    round.max_iterations = config_.iterations_a_round;
    mu_ = first_sharpness();
    while (outcome.rounds < config_.max_rounds && !(limits.cancelled && limits.cancelled())) {
      ++outcome.rounds;
      outcome.solve = move(round);
      const bool settled = weigh();
      if (limits.progress) limits.progress(outcome.rounds, outcome.solve.objective);
      if (settled) break;
      mu_ *= config_.sharpening;
    }
    outcome.solve = move(limits);
    outcome.weights = weights_;
    return outcome;
  }

 private:
  SolveOutcome move(const SolveLimits& limits) {
    const SolveOutcome outcome = minimise(problem_.problem(), limits);
    problem_.copy_to(graph_.poses);
    return outcome;
  }

  /// So small that even the worst edge starts with half its weight: the surrogate is then convex.
  double first_sharpness() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (suspect_[k]) worst = std::max(worst, chi2(graph_, graph_.edges[k]));
    }
    return worst > limit_ ? limit_ / (2.0 * worst - limit_) : 1.0;
  }

  /// New weights; true when every edge is either kept or dropped.
  bool weigh() {
    bool settled = true;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (!suspect_[k]) continue;
      weights_[k] = tls_weight(chi2(graph_, graph_.edges[k]), limit_, mu_);
      settled = settled && (weights_[k] == 0.0 || weights_[k] == 1.0);
    }
    return settled;
  }

  PoseGraph<Group>& graph_;
  const std::vector<bool>& suspect_;
  const GncConfig config_;
  const double limit_;
  double mu_ = 1.0;
  std::vector<double> weights_;
  std::deque<WeightLoss> losses_;
  GraphProblem<Group> problem_;
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
