#pragma once
// A drive in circles as keyframes with noisy odometry and known truth, and sources that say what a test tells them. No
// points, no sensors.

#include <cmath>
#include <optional>
#include <vector>

#include "estimator/graph/gnss_position.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/math/se3.hpp"
#include "estimator/types/keyframe.hpp"
#include "tests/support/random_states.hpp"

namespace slamd::test {

struct GraphDriveConfig {
  std::size_t keyframes = 200;
  std::size_t keyframes_a_lap = 100;
  double step_m = 1.5;
  double sigma_m = 0.01;       // of a step, an axis
  double sigma_rad = 0.001;
  std::uint64_t seed = 1;
};

inline Matrix6d diagonal6(double sigma_m, double sigma_rad) {
  Vector6d variance;
  variance.head<3>().setConstant(sigma_m * sigma_m);
  variance.tail<3>().setConstant(sigma_rad * sigma_rad);
  return variance.asDiagonal();
}

struct GraphDrive {
  std::vector<Keyframe> keyframes;
  std::vector<Pose> truth;  // T_map_base; the first is identity

  explicit GraphDrive(const GraphDriveConfig& config) {
    Random random{config.seed};
    const double turn = 2.0 * M_PI / static_cast<double>(config.keyframes_a_lap);
    const Pose step{exp_so3({0.0, 0.0, turn}), {config.step_m, 0.0, 0.0}};
    Pose T_map_base;
    Pose T_odom_base;
    for (std::size_t i = 0; i < config.keyframes; ++i) {
      if (i > 0) {
        Vector6d e;
        e.head<3>() = normal3(random, config.sigma_m);
        e.tail<3>() = normal3(random, config.sigma_rad);
        T_map_base = T_map_base * step;
        T_odom_base = T_odom_base * boxplus(step, e);
      }
      Keyframe keyframe;
      keyframe.id = i;
      keyframe.state.time = HostTime{std::chrono::milliseconds{500 * static_cast<std::int64_t>(i)}};
      keyframe.state.T_odom_base = T_odom_base;
      if (i > 0) keyframe.relative_covariance = diagonal6(config.sigma_m, config.sigma_rad);
      keyframe.up_base = T_map_base.rotation.conjugate() * Eigen::Vector3d::UnitZ();
      keyframe.up_sigma_rad = 0.002;
      keyframes.push_back(keyframe);
      truth.push_back(T_map_base);
    }
  }

  /// A closure with little noise between two keyframes, right but for `wrong_by`.
  LoopClosure closure(std::size_t from, std::size_t to, const Pose& wrong_by = {}) const {
    return {from, to, truth[from].inverse() * truth[to] * wrong_by, diagonal6(0.02, 0.002)};
  }
};

/// Root mean square distance of positions from the truth.
template <class Estimates>
double rmse(const Estimates& estimates, const std::vector<Pose>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (estimates[i].T_map_base.translation - truth[i].translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

/// Says what it is told to.
struct ScriptedLoops : LoopSource {
  std::vector<LoopClosure> now;
  bool changed = false;
  std::vector<double> weights;

  void add(const Keyframe&) override {}
  bool update(const GraphView&, const Cancelled& = {}) override { return std::exchange(changed, false); }
  std::span<const LoopClosure> closures() const override { return now; }
  void weigh(std::span<const double> w) override { weights.assign(w.begin(), w.end()); }
  std::span<const LoopCandidateReport> reports() const override { return {}; }
};

/// Likewise for positions.
struct ScriptedPositions : PositionSource {
  std::vector<GnssPosition> now;
  std::optional<EnuAlignment> start;
  bool changed = false;
  std::vector<double> weights;

  void add(const Keyframe&) override {}
  void add(const GnssFix&) override {}
  bool update(const GraphView&, const std::optional<EnuAlignment>&) override { return std::exchange(changed, false); }
  std::span<const GnssPosition> positions() const override { return now; }
  std::optional<EnuAlignment> initial_alignment() const override { return start; }
  EnuOrigin origin() const override { return {50.0, 8.0, 100.0}; }
  GnssLatency latency() const override { return {}; }
  GnssTrust trust(HostTime) const override { return GnssTrust::kTrusted; }
  std::vector<FixReport> reports() const override { return {}; }
  void weigh(std::span<const double> w) override { weights.assign(w.begin(), w.end()); }
};

}  // namespace slamd::test
