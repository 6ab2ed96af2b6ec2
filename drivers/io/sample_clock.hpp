#pragma once
// Times of equally spaced samples that carry no stamp, from their arrival alone: counts periods and lets ClockSync find
// phase and true period. It is not for streams with device stamps: those go to ClockSync directly.

#include <cstdint>
#include <optional>

#include "drivers/io/clock_sync.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// One thread uses an instance; no allocation, O(1) per sample, deterministic. Jitter must stay below half a period,
/// but for bursts: samples that waited together and then arrive together.
class SampleClock {
 public:
  struct Config {
    Duration nominal_period{5'000'000};
    double period_sigma_ppm = 10'000.0;  // how far the true period may be off: 208 Hz is 38,000 ppm from 200 Hz
    double expected_jitter_s = 1.7e-3;
    Duration min_latency{300'000};  // constant part of the delay from measurement to arrival
  };

  explicit SampleClock(const Config& config);

  /// arrival  of this sample
  /// next     of the following one, when it is known already: tells a late sample from missing ones
  /// Returns the host time of the sample; equal to the previous one's when more samples arrive than time has passed.
  HostTime update(HostTime arrival, std::optional<HostTime> next = std::nullopt);

  /// Counts periods since the first sample; -1 before it.
  std::int64_t index() const { return index_; }
  /// Host time of any sample near the newest one, as known now: better than what update() could say at its time.
  HostTime time_of(std::int64_t index) const { return sync_.to_host(at(index)); }
  /// Samples that never came, up to now.
  std::uint64_t missing() const { return missing_; }
  /// The true period as estimated.
  double period_s() const { return to_seconds(config_.nominal_period) * (1.0 + sync_.skew_ppm() * 1e-6); }
  Duration sigma() const { return sync_.sigma(); }
  bool locked() const { return sync_.locked(); }
  std::uint32_t jumps() const { return sync_.jumps(); }

 private:
  DeviceTime at(std::int64_t index) const { return DeviceTime{index * config_.nominal_period}; }
  std::int64_t periods_until(HostTime arrival) const;

  Config config_;
  ClockSync sync_;
  std::int64_t index_ = -1;
  std::uint64_t missing_ = 0;
};

}  // namespace slamd
