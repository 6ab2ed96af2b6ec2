#pragma once
// Fixes tied to the keyframes between which they were taken: where the antenna was in the vehicle's own frame then. Judges
// nothing: gates and alignment come after.

#include <optional>
#include <span>
#include <vector>

#include "estimator/graph/gnss_position.hpp"
#include "estimator/graph/relative_pose.hpp"
#include "estimator/math/geodesy.hpp"

namespace slamd {

/// A fix between keyframes `keyframe` and `keyframe + 1`.
struct TiedFix {
  FixReport report;
  GnssPosition position;     // sigma_m as the driver said
  Eigen::Vector3d velocity_odom_mps = Eigen::Vector3d::Zero();       // of the antenna
  Eigen::Vector3d acceleration_odom_mps2 = Eigen::Vector3d::Zero();  // of the base
  std::optional<Eigen::Vector2d> velocity_enu_mps;  // measured; where the receiver is slow it knows no course
  double since_last_s = 0.0;                        // since the fix before
  HostTime time;
};

class GnssTrack {
 public:
  explicit GnssTrack(const Eigen::Vector3d& p_base_antenna) : p_base_antenna_{p_base_antenna} {}

  void add(const Keyframe& keyframe);
  /// The pose of keyframe i at `time`, which lies between it and the next one: cubic in position with the velocities of
  /// both, even in rotation. Null when the vehicle may have stood in between, or there is no next one.
  std::optional<Pose> T_keyframe_base(std::size_t i, HostTime time) const;
  /// Index of the last keyframe not younger than `time`; null when there is none, or none follows yet.
  std::optional<std::size_t> keyframe_before(HostTime time) const;
  /// True when no keyframe younger than `time` has come yet.
  bool is_ahead(HostTime time) const { return knots_.empty() || knots_.back().time <= time; }

  std::size_t bytes() const { return knots_.size() * sizeof(Knot); }

  /// Ties a fix with the given time and ENU position; null as T_keyframe_base.
  std::optional<TiedFix> tie(const GnssFix& fix, HostTime time, const Eigen::Vector3d& p_enu) const;

 private:
  struct Knot {
    HostTime time;
    Pose T_odom_base;
    Eigen::Vector3d velocity_mps;
  };

  Eigen::Vector3d p_base_antenna_;
  std::vector<Knot> knots_;
};

}  // namespace slamd
