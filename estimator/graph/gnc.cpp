#include "estimator/graph/gnc.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "estimator/graph/chordal.hpp"
#include "estimator/graph/edge_costs.hpp"
#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/loop_consensus.hpp"
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
      : graph_{graph}, suspect_{suspect}, config_{config},
        promised_{chi2_quantile(Group::kDof, config.outlier_probability)}, barred_(graph.edges.size(), false),
        weights_(graph.edges.size(), 1.0) {}

  RobustOutcome run(const SolveLimits& limits) {
    const std::vector<bool> consenting = consenting_edges(graph_, suspect_, {}, limits.cancelled);
    for (std::size_t k = 0; k < weights_.size(); ++k) weights_[k] = consenting[k] ? 1.0 : 0.0;
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
    while (bar_the_worst_lone_edge()) outcome.solve = settle(limits);
    if (take_in_what_costs_little()) outcome.solve = settle(limits);
    while (bar_the_worst_lone_edge()) outcome.solve = settle(limits);
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
    const double limit = limit_at(noise_scale());
    if (limit > 0.9 * limit_) return false;
    limit_ = limit;
    return true;
  }

  /// The chi2 that tells right from wrong where errors have this scale.
  double limit_at(double scale) const {
    return promised_ * std::min(config_.noise_margin * scale, config_.information_margin);
  }

  /// As config.noise_margin, less where the kept loops' errors have the tails that their information promises.
  double margin_of_kept() const {
    constexpr double kTail = 0.025;
    constexpr std::size_t kEnough = 100;
    std::vector<double> errors;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (suspect_[k] && weights_[k] >= 0.5) errors.push_back(chi2(graph_, graph_.edges[k]));
    }
    if (errors.size() < kEnough) return config_.noise_margin;
    std::ranges::sort(errors);
    const double tail = errors[static_cast<std::size_t>((1.0 - kTail) * static_cast<double>(errors.size()))];
    const double promised = chi2_quantile(Group::kDof, kTail) / chi2_quantile(Group::kDof, 0.5);
    const double heaviness = tail / std::max(errors[errors.size() / 2], std::numeric_limits<double>::min()) / promised;
    return std::clamp(config_.least_margin * heaviness, config_.least_margin, config_.noise_margin);
  }

  /// Likewise of what an edge costs the whole, which takes in the drift of the chain around it.
  double cost_limit() const {
    return promised_ * margin_of_kept() * std::min(scale_of_kept(), config_.information_margin);
  }

  std::vector<bool> kept() const {
    std::vector<bool> kept;
    for (const double weight : weights_) kept.push_back(weight >= 0.5);
    return kept;
  }

  /// Objective of the kept edges a degree of freedom: their scale with its tails, once what is wrong is out.
  double scale_of_kept() const {
    double sum = 0.0;
    auto spare = -std::ranges::count(graph_.fixed, false);
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (weights_[k] < 0.5) continue;
      sum += chi2(graph_, graph_.edges[k]);
      ++spare;
    }
    return spare > 0 ? sum / static_cast<double>(spare * Group::kDof) : 1.0;
  }

  /// A right edge that alone joins what drifted apart looks wrong until it is in: near ones are taken in together, and stay
  /// when the rest can agree with them; then edges within the limit are taken until nothing changes.
  SolveOutcome give_second_chance(const SolveLimits& limits) {
    const std::vector<double> kept = weights_;
    limit_ = std::max(limit_, limit_at(scale_of_kept()));
    keep_within(config_.second_chance * limit_);
    move_from_start(limits);
    keep_within(limit_);
    for (std::size_t k = 0; k < weights_.size(); ++k) weights_[k] = std::max(weights_[k], kept[k]);
    return settle(limits);
  }

  /// Edges that are out and would fit if they were in: what those cost that stays wrong lies far above. True when there are any.
  bool take_in_what_costs_little() {
    std::vector<std::size_t> near;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const bool out = weights_[k] == 0.0 && !barred_[k];
      if (out && chi2(graph_, graph_.edges[k]) < config_.second_chance * limit_) near.push_back(k);
    }
    const std::vector<double> costs = costs_of_adding(graph_, kept(), near);
    const double limit = cost_limit();
    bool any = false;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (costs[i] > limit) continue;
      weights_[near[i]] = 1.0;
      any = true;
    }
    return any;
  }

  /// Until the kept set agrees with its own solution.
  SolveOutcome settle(const SolveLimits& limits) {
    SolveOutcome outcome = move_from_start(limits);
    for (int i = 0; i < config_.last_rounds && keep_within(limit_); ++i) outcome = move_from_start(limits);
    return outcome;
  }

  /// A wrong edge that no kept one confirms bends a stretch that nothing else holds until its own error is small; what it
  /// adds to the whole is not. Takes the worst of them out for good; false when there is none.
  bool bar_the_worst_lone_edge() {
    const std::optional<LoneEdge> worst = worst_lone_edge(graph_, kept(), suspect_);
    if (!worst || worst->adds <= cost_limit()) return false;
    barred_[worst->edge] = true;
    weights_[worst->edge] = 0.0;
    limit_ = std::min(limit_, limit_at(scale_of_kept()));
    return true;
  }

  SolveOutcome move_from_start(const SolveLimits& limits) {
    return initialise_chordal(graph_, weights_) ? move(limits) : SolveOutcome{};
  }

  /// True when another set is kept than before.
  bool keep_within(double limit) {
    const std::vector<double> before = weights_;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      if (suspect_[k] && !barred_[k]) weights_[k] = chi2(graph_, graph_.edges[k]) < limit ? 1.0 : 0.0;
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
  const double promised_;     // chi2 that a right edge exceeds with outlier_probability, when its information is true
  std::vector<bool> barred_;  // wrong for good
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
