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
    Duration min_latency{0};              // constant part of the delay from measurement to arrival
    DelayEnvelope::Config envelope;       // window, expected jitter and skew
    Duration jump_threshold{3'000'000};   // a delay that changes by more than this is a jump of a clock or late data
    Duration jump_confirm{300'000'000};   // late data end within this host time, a jump does not;
    Duration most_hold{10'000'000'000};   // within this where they became late in a pause of arrivals,
    Duration most_held{1'000'000'000};    // by no more than this,
    Duration most_step{20'000'000};       // in which the device itself did not pause: it stamped on by no more than this
    Duration reorder_limit{250'000'000};  // a device time that falls back by more is a reset of the device
    Duration lock_sigma{100'000};         // locked() below this
    double slew_ppm = 2000.0;             // largest correction of the output's rate while locked,
    Duration max_step{15'000};            // and at one sample
    double acquire_slew_ppm = 500'000.0;  // before lock
  };

  explicit ClockSync(const Config& config) : config_{config}, envelope_{config.envelope} {}

  /// One stamp of the device and when its datum arrived. Returns the host time of `device`. Later device times give
  /// later host times, except after a jump that leaves the output more than Config::reorder_limit in the future: there
  /// it steps back. A device time that falls back by less than that is a reordered datum and is only mapped.
  HostTime update(DeviceTime device, HostTime arrival);

  /// Host time of any device time near the newest one, with the mapping of the last update(). Origin before the first.
  HostTime to_host(DeviceTime device) const;

  /// Device seconds are this much shorter than the host's: d(host)/d(device) = 1 + skew_ppm * 1e-6.
  double skew_ppm() const { return (rate_ - 1.0) * 1e6; }
  /// One standard deviation of the skew; without meaning before the first update().
  double skew_sigma_ppm() const { return envelope_.line().skew_sigma * 1e6; }
  /// One standard deviation of to_host() at the last update, without the unknown part of min_latency.
  Duration sigma() const;
  /// Width of the arrival jitter as learnt so far.
  Duration jitter() const { return Duration{static_cast<std::int64_t>(envelope_.jitter_ns())}; }
  /// The mapping is as good as Config::lock_sigma; false from a jump until it is again.
  bool locked() const { return locked_; }
  /// From a jump on until the mapping is locked again.
  bool is_recovering() const { return jumps_ > 0 && !locked_; }
  /// Jumps and resets of either clock since construction.
  std::uint32_t jumps() const { return jumps_; }

 private:
  enum class Arrival : std::uint8_t { kPlausible, kLate, kJump };

  Arrival judge(double x_s, double delay_ns, HostTime arrival, Duration paused);
  bool is_held(double excess_ns, Duration paused) const;
  bool has_strayed(DeviceTime device, double x_s) const;
  HostTime estimate(DeviceTime device, double x_s) const;
  double gate_ns(double x_s) const;
  void restart(DeviceTime device, HostTime arrival);
  void seat(DeviceTime device, HostTime target);
  HostTime follow(DeviceTime device, HostTime target);

  Config config_;
  DelayEnvelope envelope_;
  DeviceTime origin_device_{};  // delays are relative to these two, so that doubles keep their nanoseconds
  HostTime origin_host_{};
  DeviceTime pivot_device_{};  // newest output: the mapping runs through it with slope rate_
  HostTime pivot_host_{};
  double rate_ = 1.0;
  double slew_left_ns_ = 0.0;  // what the output still lacks of the estimate
  HostTime last_arrival_{};
  HostTime late_since_{};      // arrival of the first of late_count_ late samples in a row
  std::uint32_t late_count_ = 0;
  bool held_ = false;          // those: the data come late, and the clocks are as they were
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
