#pragma once
// A start while moving: the velocity is unknown, so the first scans are skewed. Until a few of them have fused only what
// they say of the velocity is kept. Owns no map.

#include "estimator/filter/ieskf.hpp"
#include "estimator/filter/initialisation.hpp"

namespace slamd {

struct VelocitySearchConfig {
  std::uint32_t scans = 6;            // fused ones until the velocity is known
  double found_sigma_mps = 3.0;       // of each of them: two skewed scans agree on a wrong velocity
  std::uint32_t settling_scans = 20;  // fused after those, then the map that the skewed ones began is begun anew
  double limit_s = 8.0;               // not found in this time: the vehicle is LOST until it is
  std::uint32_t max_unfused = 3;      // scans in a row, then the search goes on from the newest one
};

class VelocitySearch {
 public:
  explicit VelocitySearch(const VelocitySearchConfig& config) : config_{config} {}

  /// Begins with the first state of a moving vehicle. Without an IMU nothing settles: no bias and no gravity are learnt.
  void begin(const InitialState& initial);
  void end() { left_ = 0; }

  bool is_on() const { return left_ > 0; }
  bool is_overdue(HostTime at) const { return is_on() && at - initial_.time > from_seconds(config_.limit_s); }
  std::uint32_t max_unfused() const { return config_.max_unfused; }

  /// One scan has fused. Returns whether the map is to begin anew with it: with every scan while the velocity is unknown,
  /// and once more when all has settled.
  bool fused(const UpdateSummary& update, FilterSnapshot& filter);

 private:
  void keep_velocity(const UpdateSummary& update, FilterSnapshot& filter) const;

  VelocitySearchConfig config_;
  FilterSnapshot initial_;
  std::uint32_t settling_ = 0;  // of left_
  std::uint32_t left_ = 0;
};

}  // namespace slamd
