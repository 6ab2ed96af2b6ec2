// slam-pgo: solves a pose graph file with slamd's back end.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "estimator/graph/chordal.hpp"
#include "estimator/graph/gnc.hpp"
#include "tools/slam-pgo/g2o_file.hpp"
#include "tools/slam-pgo/loops.hpp"
#include "tools/slam-pgo/objective.hpp"

namespace {

using namespace slamd;

enum ExitCode { kOk = 0, kBadInput = 1, kBadOptions = 2, kCannotWrite = 3 };

struct Options {
  std::string file, out, objective = "chi2", initial = "chordal";
  bool robust = false, quiet = false;
  int max_iterations = 100;
};

template <class Group>
void tell_objectives(const char* when, const PoseGraph<Group>& graph) {
  std::printf("%-8s chi2 %.8g   SE-Sync objective %.8g\n", when, objective(graph), objective(pgo::sesync(graph)));
}

SolveLimits limits_of(const Options& options) {
  SolveLimits limits;
  limits.max_iterations = options.max_iterations;
  limits.relative_tolerance = 1e-9;
  if (!options.quiet) {
    limits.progress = [](int iteration, double objective) {
      std::fprintf(stderr, "iteration %3d  objective %.8g\n", iteration, objective);
    };
  }
  return limits;
}

/// Robust: the loops that were dropped are left out of the graph, so that what is told afterwards is of the kept edges.
template <class Group>
SolveOutcome optimise(PoseGraph<Group>& work, const std::vector<bool>& loops, const Options& options) {
  if (!options.robust) return solve(work, limits_of(options));
  SolveLimits limits = limits_of(options);
  const RobustOutcome robust = solve_robustly(work, loops, {}, limits);
  if (robust.weights.empty()) return {};
  const auto dropped = std::count_if(robust.weights.begin(), robust.weights.end(), [](double w) { return w < 0.5; });
  std::printf("robust   %d rounds, %td loop edges dropped:", robust.rounds, dropped);
  for (std::size_t k = 0; k < work.edges.size(); ++k) {
    if (robust.weights[k] < 0.5) std::printf(" %zu", k);
  }
  std::printf("\n");
  return robust.solve;
}

template <class Group>
bool start(PoseGraph<Group>& graph, const std::vector<bool>& loops, const Options& options) {
  if (options.initial == "file") return true;
  std::vector<double> weights(graph.edges.size(), 1.0);
  if (options.initial == "odometry") {
    for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = loops[k] ? 1e-9 : 1.0;
  }
  return initialise_chordal(graph, weights);
}

template <class Group>
int run(pgo::G2oGraph<Group>& g2o, const Options& options) {
  using Clock = std::chrono::steady_clock;
  const std::vector<bool> loops = pgo::loops_of(g2o.graph);
  std::printf("graph    %zu poses, %zu edges, %td of them loops, %dD\n", g2o.graph.poses.size(), g2o.graph.edges.size(),
              std::count(loops.begin(), loops.end(), true), Group::kDimension);
  const auto begin = Clock::now();
  PoseGraph<Group> work = options.objective == "sesync" ? pgo::sesync(g2o.graph) : g2o.graph;
  anchor_parts(work);
  if (!start(work, loops, options)) {
    std::fprintf(stderr, "slam-pgo: %s: no chordal initialisation: the linear problem is singular\n", options.file.c_str());
    return kBadInput;
  }
  g2o.graph.poses = work.poses;
  tell_objectives("initial", g2o.graph);
  const auto started = Clock::now();
  const SolveOutcome outcome = optimise(work, loops, options);
  const auto end = Clock::now();
  g2o.graph.poses = work.poses;
  tell_objectives("final", g2o.graph);
  const auto seconds = [](auto span) { return std::chrono::duration<double>(span).count(); };
  std::printf("solve    %d iterations, %s, %.3f s (initialisation %.3f s)\n", outcome.iterations,
              outcome.converged ? "converged" : "not converged", seconds(end - begin), seconds(started - begin));
  return kOk;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Solves a pose graph in g2o format (2D or 3D) with slamd's back end."};
  app.add_option("FILE", options.file, "VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT, FIX")->required();
  app.add_option("--out", options.out, "the solved graph, same format")->required();
  app.add_option("--objective", options.objective, "what is minimised: chi2 (the file's information) or sesync (isotropic)")
      ->check(CLI::IsMember({"chi2", "sesync"}))->capture_default_str();
  app.add_option("--init", options.initial, "chordal (from the edges), odometry (edges between neighbours in the order of ids) or file")
      ->check(CLI::IsMember({"chordal", "odometry", "file"}))->capture_default_str();
  app.add_option("--max-iterations", options.max_iterations)->check(CLI::Range(0, 10000))->capture_default_str();
  app.add_flag("--robust", options.robust, "edges that are no odometry may be wrong: graduated non-convexity");
  app.add_flag("--quiet", options.quiet, "no line for each iteration on stderr");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kBadOptions;
  }
  std::ifstream in{options.file};
  if (!in) {
    std::fprintf(stderr, "slam-pgo: %s: cannot be read\n", options.file.c_str());
    return kBadInput;
  }
  std::variant<pgo::AnyGraph, pgo::G2oFault> read = pgo::read_g2o(in);
  if (const auto* fault = std::get_if<pgo::G2oFault>(&read)) {
    std::fprintf(stderr, "slam-pgo: %s:%zu: %s\n", options.file.c_str(), fault->line, fault->reason.c_str());
    return kBadInput;
  }
  pgo::AnyGraph& any = std::get<pgo::AnyGraph>(read);
  const int code = std::visit([&](auto& g2o) { return run(g2o, options); }, any);
  if (code != kOk) return code;
  std::ofstream out{options.out};
  pgo::write_g2o(out, any);
  if (!out.flush()) {
    std::fprintf(stderr, "slam-pgo: %s: cannot be written\n", options.out.c_str());
    return kCannotWrite;
  }
  return kOk;
}
