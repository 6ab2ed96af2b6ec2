#pragma once
// What the GPS side hands to the graph: antenna positions in ENU tied to keyframes. Gates, latency and the quality latch
// are behind a PositionSource.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimator/graph/gnss_latency.hpp"
#include "estimator/graph/gnss_trust.hpp"
#include "estimator/graph/graph_solution.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

/// One position of the antenna: p_enu = T_enu_map * T_map_base(keyframe) * p_keyframe_antenna + noise.
struct GnssPosition {
  std::uint64_t keyframe = 0;  // the nearest in time
  /// The antenna at the instant of the fix, in this keyframe's base: T_keyframe_base(fix) * p_base_antenna, the first by
  /// interpolating the odometry between keyframes.
  Eigen::Vector3d p_keyframe_antenna = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_enu = Eigen::Vector3d::Zero();       // measured, metres
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Ones();     // east, north, up; a height that is not valid has a large one
};

/// What became of a fix. Numbers are those of gps.csv and never reused.
enum class FixVerdict : std::uint8_t {
  kAccepted = 0,
  kStale = 1,        // the receiver repeats itself
  kQuality = 2,      // no fix, dead reckoning, or weaker than the configuration permits
  kUntied = 3,       // no two keyframes close enough around it: at rest, before the start, after a gap
  kUnaligned = 4,    // before the yaw between map and ENU was known; judged again later
  kInnovation = 5,   // beyond the gate
  kDistrusted = 6,   // inside the gate, but the source failed too long before and has not yet earned trust again
};

struct FixReport {
  std::uint64_t number = 0;  // in order of arrival
  HostTime time;
  FixVerdict verdict = FixVerdict::kUntied;
  double chi2 = 0.0;         // of the horizontal innovation, 2 degrees of freedom; NaN where it did not come so far
  double innovation_m = 0.0;  // horizontal
  double sigma_m = 0.0;       // as the driver believed
};

/// Turns fixes into positions. Called by the mapper alone, one thread; deterministic.
class PositionSource {
 public:
  virtual ~PositionSource() = default;
  virtual void add(const Keyframe& keyframe) = 0;
  virtual void add(const GnssFix& fix) = 0;
  /// Looks at what came since the last call. alignment: as the graph has it, nullopt before the first solve with
  /// positions. True when the graph should be solved again: a batch of new positions, or old ones withdrawn.
  virtual bool update(const GraphView& view, const std::optional<EnuAlignment>& alignment) = 0;
  /// All positions that the graph shall heed; empty until initial_alignment() has a value, and while the track needs no
  /// bending. In order of keyframes.
  virtual std::span<const GnssPosition> positions() const = 0;
  /// Of the track as it is, yaw from motion: where the graph starts, and what is published while there are no positions.
  /// nullopt: not enough motion or fixes yet. Covariance: as far as known.
  virtual std::optional<EnuAlignment> initial_alignment() const = 0;
  /// Only with initial_alignment().
  virtual EnuOrigin origin() const = 0;
  /// After each solve: robust weight of each of positions(), in their order, 0..1.
  virtual void weigh(std::span<const double> weights) = 0;
  /// Estimated on the way, on top of the latency that the driver took off already.
  virtual GnssLatency latency() const = 0;
  /// now  the newest host time known
  virtual GnssTrust trust(HostTime now) const = 0;
  /// One a fix, in order of arrival, with its verdict; of those that were never between two keyframes the newest 100,000.
  virtual std::vector<FixReport> reports() const = 0;
  /// Of memory that grows with the drive.
  virtual std::size_t bytes() const { return 0; }
};

}  // namespace slamd
