#pragma once
// One run of the solver over a problem that somebody else has built: options, cancelling, outcome. The only place that
// knows how Ceres is set up.

#include <ceres/problem.h>

#include <functional>

namespace slamd {

struct SolveLimits {
  int max_iterations = 50;
  double relative_tolerance = 1e-6;  // of the objective; smaller changes end the solve
  double initial_damping = 1e-8;     // Levenberg-Marquardt; 0 < damping, small = Gauss-Newton from the start
  /// Asked before each iteration; true ends the solve, and what was reached so far stays. Empty: never.
  std::function<bool()> cancelled;
  /// Told each iteration and its objective. Empty: nobody is.
  std::function<void(int iteration, double objective)> progress;
};

struct SolveOutcome {
  double initial_objective = 0.0;  // sum of squared, whitened, robustly weighted errors
  double objective = 0.0;
  int iterations = 0;
  bool converged = false;  // false: cancelled, out of iterations, or failed
  bool cancelled = false;  // SolveLimits::cancelled said so
  bool usable = false;     // false: the variables are as they were
};

/// Moves the problem's variables to the next minimum: sparse Cholesky on one thread, so two runs give the same bits.
SolveOutcome minimise(ceres::Problem& problem, const SolveLimits& limits);

}  // namespace slamd
