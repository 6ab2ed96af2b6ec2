#pragma once
// The gate between the IMU and the filter: takes samples that are in order, finite and of a working sensor into the buffer,
// counts the others by cause. Moves no state.

#include "estimator/odometry/clock_doubt.hpp"
#include "estimator/odometry/imu_buffer.hpp"
#include "estimator/odometry/imu_sanity.hpp"

namespace slamd {

struct ImuIntakeConfig {
  ImuSanityConfig sanity;
  double timeout_s = 0.25;   // no usable sample for so long: the IMU is absent
};

/// Samples that were not used, by cause.
struct ImuIntakeStats {
  std::uint64_t not_finite = 0;
  std::uint64_t out_of_order = 0;    // not younger than the newest one
  std::uint64_t in_future = 0;       // stamped later than received
  std::uint64_t frozen = 0;          // the sensor was stuck
  std::uint64_t implausible = 0;     // beyond what sensor or vehicle can do
  std::uint64_t clock_restarts = 0;  // the stamps stepped back for good: the older samples were forgotten
};

class ImuIntake {
 public:
  explicit ImuIntake(const ImuIntakeConfig& config) : config_{config}, sanity_{config.sanity} {}

  /// True when the sample was taken. A sample that ends the patience with a stuck sensor takes back its like from the
  /// buffer; after kBackwardSamples in a row that are older than the newest one the clock is taken to have stepped back:
  /// the buffer is emptied and goes on with them.
  bool add(const ImuSample& sample);
  const ImuBuffer& samples() const { return samples_; }

  /// Whether a working IMU was heard within timeout_s before `at`.
  bool is_alive(HostTime at) const;
  /// Whether samples reach up to `at`.
  bool covers(HostTime at) const { return !samples_.empty() && samples_.newest().time >= at; }
  const ImuSanity& sanity() const { return sanity_; }
  bool is_clock_unsure(HostTime at) const { return clock_doubt_.holds(at); }
  const ImuIntakeStats& stats() const { return stats_; }

  static constexpr std::uint32_t kBackwardSamples = 20;

 private:
  bool is_in_order(const ImuSample& sample);

  ImuIntakeConfig config_;
  ImuSanity sanity_;
  ImuBuffer samples_;
  ClockDoubt clock_doubt_;
  std::optional<HostTime> newest_;    // in order, taken or not
  HostTime newest_backward_;
  std::uint32_t backward_ = 0;        // in a row
  ImuIntakeStats stats_;
};

}  // namespace slamd
