#pragma once
// A start while moving: velocity, gravity and biases are unknown, so the first scans are skewed. Finds the velocity from scan
// to scan, then settles round by round until a round has nothing left to correct. Owns no map.

#include "estimator/filter/ieskf.hpp"
#include "estimator/filter/initialisation.hpp"

namespace slamd {

struct VelocitySearchConfig {
  std::uint32_t scans = 3;            // fused one against the other until a velocity is known
  double found_sigma_mps = 3.0;       // of each of them: two skewed scans agree on a wrong velocity
  std::uint32_t round_scans = 10;     // fused on one map; what an unsettled state put into it keeps its skew
  double round_sigma_mps = 1.0;       // of the velocity at the begin of the next round
  double round_gyro_bias_rads = 0.01; // likewise
  std::uint32_t least_rounds = 2;     // the first stands on a velocity that skewed scans gave
  double settled_mps = 0.2;           // a round that corrected the velocity by less, as a whole, is the last one
  double settled_test_ratio = 1.6;    // if the second half of its scans agreed with its map so well
  double limit_s = 8.0;               // not settled in this time: the vehicle is LOST until it is
  std::uint32_t max_unfused = 3;      // scans in a row, then the search goes on from the newest one
};

class VelocitySearch {
 public:
  explicit VelocitySearch(const VelocitySearchConfig& config) : config_{config} {}

  /// Begins with the first state of a moving vehicle; one whose motion is known needs one round only. Without an IMU nothing settles: no bias and no gravity are learnt.
  void begin(const InitialState& initial);
  void end() { is_on_ = false; }

  bool is_on() const { return is_on_; }
  bool is_overdue(HostTime at) const { return is_on_ && at - initial_.time > from_seconds(config_.limit_s); }
  std::uint32_t max_unfused() const { return config_.max_unfused; }

  /// One scan has fused. Returns whether the map is to begin anew with it: with every scan while the velocity is unknown, and
  /// after every round. A round that was not the last one leaves in
  /// `filter` what it found, with the uncertainty of a start.
  bool fused(const UpdateSummary& update, FilterSnapshot& filter);
  /// The map of this round was given up.
  void begin_round() { round_ = {}; }

 private:
  /// The scans that were fused on one map.
  struct Round {
    std::uint32_t scans = 0;
    Eigen::Vector3d corrected_mps = Eigen::Vector3d::Zero();
    double late_test_ratio = 0.0;   // sum over the second half
  };

  void keep_velocity(const UpdateSummary& update, FilterSnapshot& filter) const;
  void count(const UpdateSummary& update);
  bool has_settled() const;
  void doubt(FilterSnapshot& filter) const;

  VelocitySearchConfig config_;
  FilterSnapshot initial_;
  bool settles_ = false;
  bool motion_known_ = false;
  bool is_on_ = false;
  std::uint32_t unknown_ = 0;   // scans that are left until a velocity is known
  std::uint32_t rounds_ = 0;    // that have ended
  Round round_;
};

}  // namespace slamd
