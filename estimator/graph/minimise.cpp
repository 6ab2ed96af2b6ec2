#include "estimator/graph/minimise.hpp"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

namespace slamd {
namespace {

class Watch final : public ceres::IterationCallback {
 public:
  explicit Watch(const SolveLimits& limits) : limits_{limits} {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (limits_.progress) limits_.progress(summary.iteration, 2.0 * summary.cost);
    cancelled_ = limits_.cancelled && limits_.cancelled();
    return cancelled_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool cancelled() const { return cancelled_; }

 private:
  const SolveLimits& limits_;
  bool cancelled_ = false;
};

ceres::Solver::Options options_of(const SolveLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.max_num_iterations = limits.max_iterations;
  options.function_tolerance = limits.relative_tolerance;
  options.initial_trust_region_radius = 1.0 / limits.initial_damping;
  options.max_trust_region_radius = 1e16;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

SolveOutcome minimise(ceres::Problem& problem, const SolveLimits& limits) {
  Watch watch{limits};
  ceres::Solver::Options options = options_of(limits);
  if (limits.cancelled || limits.progress) options.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  SolveOutcome outcome;
  outcome.initial_objective = 2.0 * summary.initial_cost;
  outcome.objective = 2.0 * summary.final_cost;
  outcome.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  outcome.converged = summary.termination_type == ceres::CONVERGENCE;
  outcome.cancelled = watch.cancelled();
  outcome.usable = summary.IsSolutionUsable();
  return outcome;
}

}  // namespace slamd
