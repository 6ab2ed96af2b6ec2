#include "drivers/io/sample_clock.hpp"

#include <cmath>

namespace slamd {
namespace {

constexpr std::int64_t kHostJumpPeriods = -40;  // arrival so far before its time: the host's clock went back

ClockSync::Config sync_config(const SampleClock::Config& config) {
  ClockSync::Config sync;
  sync.min_latency = config.min_latency;
  sync.envelope.expected_jitter_s = config.expected_jitter_s;
  sync.envelope.skew_sigma_ppm = config.period_sigma_ppm;
  return sync;
}

}  // namespace

SampleClock::SampleClock(const Config& config) : config_{config}, sync_{sync_config(config)} {}

/// Periods from the newest sample to the one that arrived now, by rounding with the middle of the jitter.
std::int64_t SampleClock::periods_until(HostTime arrival) const {
  const HostTime usual_arrival = sync_.to_host(at(index_)) + config_.min_latency + sync_.jitter() / 2;
  return std::llround(to_seconds(arrival - usual_arrival) / period_s());
}

HostTime SampleClock::update(HostTime arrival, std::optional<HostTime> next) {
  if (index_ < 0) return sync_.update(at(index_ = 0), arrival);
  std::int64_t periods = periods_until(arrival);
  const bool queued = next && *next - arrival < config_.nominal_period / 2;
  if ((periods > 1 && queued) || periods < kHostJumpPeriods) periods = 1;
  if (periods < 1) return sync_.to_host(at(index_));
  missing_ += static_cast<std::uint64_t>(periods - 1);
  index_ += periods;
  return sync_.update(at(index_), arrival);
}

}  // namespace slamd
