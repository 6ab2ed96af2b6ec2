#pragma once
// Maps one device's clock to host time by the lower envelope of arrival delay, with its own sigma, monotone and without
// visible steps. It reads no clock and does not unwrap counters: that is CounterUnwrapper.

#include <cstdint>

#include "drivers/io/delay_envelope.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// One thread uses an instance; no allocation ever, bounded memory, O(1) per sample, deterministic.
class ClockSync {
 public:
  struct Config {
    Duration min_latency{0};            // constant part of the delay from measurement to arrival
    DelayEnvelope::Config envelope;     // window, expected jitter and skew
    Duration jump_threshold{3'000'000};     // a persistent change of delay above this is a jump of a clock
    Duration jump_confirm{1'000'000'000};   // how long it must persist when it could as well be late data
    Duration sure_jump{250'000'000};        // a delay above this is a jump at once
    Duration lock_sigma{100'000};           // locked() below this
    double slew_ppm = 2000.0;               // largest correction of the output's rate while locked
    Duration max_step{15'000};              // and largest correction at one sample
    double acquire_slew_ppm = 50'000.0;     // before lock
  };

  explicit ClockSync(const Config& config) : config_{config}, envelope_{config.envelope} {}

  /// One stamp of the device and when its datum arrived. Returns the host time of `device`. Later device times give
  /// later host times, except after a jump that would put the output more than Config::sure_jump into the future:
  /// there it steps back. A device time not later than the newest one by less than sure_jump (reordered datum) is only
  /// mapped.
  HostTime update(DeviceTime device, HostTime arrival);

  /// Host time of any device time near the newest one, with the mapping of the last update(). Origin before the first.
  HostTime to_host(DeviceTime device) const;

  /// Device seconds are this much shorter than the host's: d(host)/d(device) = 1 + skew_ppm * 1e-6.
  double skew_ppm() const { return (rate_ - 1.0) * 1e6; }
  /// One standard deviation of to_host() at the last update, without the unknown part of min_latency.
  Duration sigma() const;
  /// The mapping is as good as Config::lock_sigma; false from a jump until it is again.
  bool locked() const { return locked_; }
  /// Jumps and resets of either clock since construction.
  std::uint32_t jumps() const { return jumps_; }

 private:
  double delay_of(DeviceTime device, HostTime arrival) const;
  bool is_jump(DeviceTime device, double excess_ns);
  void restart(DeviceTime device, HostTime arrival);
  void slew_towards(DeviceTime device, double target_delay_ns);

  Config config_;
  DelayEnvelope envelope_;
  DeviceTime origin_device_{};   // delays are relative to these two, so that doubles keep their nanoseconds
  HostTime origin_host_{};
  DeviceTime pivot_device_{};    // the output line runs through (pivot_device_, pivot_host_) with slope rate_
  HostTime pivot_host_{};
  double rate_ = 1.0;
  double slew_left_ns_ = 0.0;    // what the output still lacks of the estimate
  DeviceTime last_plausible_{};  // newest sample whose delay fitted the envelope
  bool started_ = false;
  bool locked_ = false;
  std::uint32_t jumps_ = 0;
};

/// Unwraps a counter that starts again at zero after `period` (VLP-16: 3600 s). It does not smooth or check.
class CounterUnwrapper {
 public:
  explicit CounterUnwrapper(Duration period) : period_{period} {}

  /// counter  what the device sent, 0 <= counter < period
  /// arrival  tells how many whole periods a gap lasted; the answer is the candidate nearest to the elapsed host time
  DeviceTime unwrap(Duration counter, HostTime arrival);

 private:
  Duration period_;
  DeviceTime last_{};
  HostTime last_arrival_{};
  bool started_ = false;
};

}  // namespace slamd
