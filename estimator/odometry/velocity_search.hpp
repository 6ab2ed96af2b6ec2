#pragma once
// A start while moving: the velocity is unknown, so the first scans are skewed. Until a few of them have fused only what
// they say of the velocity is kept. Owns no map.

#include "estimator/filter/ieskf.hpp"

namespace slamd {

struct VelocitySearchConfig {
  std::uint32_t scans = 4;            // fused ones until the velocity is known
  double found_sigma_mps = 0.7;       // and how well it is known then
  double limit_s = 3.0;               // not found in this time: the vehicle is LOST until it is
  std::uint32_t max_unfused = 3;      // scans in a row, then the search goes on from the newest one
};

class VelocitySearch {
 public:
  explicit VelocitySearch(const VelocitySearchConfig& config) : config_{config} {}

  /// Begins with the first state of a moving vehicle.
  void begin(const FilterSnapshot& initial);
  void end() { left_ = 0; }

  bool is_on() const { return left_ > 0; }
  bool is_overdue(HostTime at) const { return is_on() && at - initial_.time > from_seconds(config_.limit_s); }
  std::uint32_t max_unfused() const { return config_.max_unfused; }

  /// One scan has fused. What skewed scans teach of biases and gravity is not kept; velocity stays unknown along the
  /// direction that the scan leaves free.
  void keep_velocity(const UpdateSummary& update, FilterSnapshot& filter);

 private:
  VelocitySearchConfig config_;
  FilterSnapshot initial_;
  std::uint32_t left_ = 0;
};

}  // namespace slamd
