#pragma once
// A simulated device: its clock against the host's and the jitter with which its data arrive. For clock tests only.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "estimator/types/time.hpp"

namespace slamd::test {

enum class Jitter : std::uint8_t { kUniform, kExponential, kHeavyTail, kBursts };

/// Data at a fixed rate; true host time is what ClockSync has to find.
class ArrivalModel {
 public:
  static constexpr std::int64_t kHostEpochNs = 1'780'300'800'000'000'000;
  static constexpr std::int64_t kDeviceEpochNs = 77'000'000'000;

  struct Datum {
    DeviceTime device;
    HostTime truth;
    HostTime arrival;
  };

  ArrivalModel(Jitter jitter, std::uint32_t seed) : jitter_{jitter}, random_{seed} {}

  double period_s = 0.005;
  double min_latency_s = 3e-4;
  double width_s = 1.7e-3;  // of uniform jitter; the others scale with it
  double skew_ppm = 0.0;    // host against device, as ClockSync says it
  double skew_drift_ppm_s = 0.0;
  double device_step_s = 0.0;  // added to the device's clock: a jump
  double host_step_s = 0.0;    // added to the host's clock
  double extra_delay_s = 0.0;  // added to the arrival: a stall

  /// The next datum, one period later. Arrivals keep their order, as bytes in a queue do.
  Datum next() {
    const double t = static_cast<double>(count_++) * period_s;
    return at(t);
  }
  void skip(std::int64_t periods) { count_ += periods; }

 private:
  Datum at(double t) {
    const double device_s = t * (1.0 - skew_ppm * 1e-6) - 0.5 * skew_drift_ppm_s * 1e-6 * t * t + device_step_s;
    newest_arrival_s_ = std::max(newest_arrival_s_, t + min_latency_s + extra_delay_s + excess());
    const std::int64_t device_us = std::llround(std::floor(device_s * 1e6));
    return {DeviceTime{Duration{kDeviceEpochNs + device_us * 1000}},
            HostTime{Duration{kHostEpochNs} + from_seconds(t + host_step_s)},
            HostTime{Duration{kHostEpochNs} + from_seconds(newest_arrival_s_ + host_step_s)}};
  }
  double excess() {
    const double u = uniform_(random_);
    switch (jitter_) {
      case Jitter::kUniform:
        return width_s * u;
      case Jitter::kExponential:
        return -0.3 * width_s * std::log(1.0 - u);
      case Jitter::kHeavyTail:
        return 0.1 * width_s * (std::pow(1.0 - u, -0.7) - 1.0);
      case Jitter::kBursts:
        break;
    }
    if (burst_left_s_ <= 0.0 && uniform_(random_) < 0.005) burst_left_s_ = 0.03;
    burst_left_s_ -= period_s;
    return std::max(burst_left_s_, 0.0) + 0.2 * width_s * u;
  }

  Jitter jitter_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::int64_t count_ = 0;
  double newest_arrival_s_ = 0.0;
  double burst_left_s_ = 0.0;
};

}  // namespace slamd::test
