#include "drivers/io/clock_sync.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {
namespace {

constexpr std::uint32_t kFewestLate = 3;  // late samples before a jump is believed
constexpr double kGateSigmas = 6.0;
constexpr Duration kSmallestTick{1'000};  // the output advances at least by this while it waits for the estimate

Duration scaled(Duration d, double factor) {
  return d + Duration{std::llround(static_cast<double>(d.count()) * factor)};
}

}  // namespace

HostTime ClockSync::to_host(DeviceTime device) const {
  return started_ ? pivot_host_ + scaled(device - pivot_device_, rate_ - 1.0) : HostTime{};
}

Duration ClockSync::sigma() const {
  if (!started_) return std::chrono::seconds{1};
  return Duration{std::llround(std::hypot(envelope_.line().sigma_ns, slew_left_ns_))};
}

HostTime ClockSync::update(DeviceTime device, HostTime arrival) {
  const bool first = !started_;
  const Duration paused = arrival - last_arrival_;
  last_arrival_ = arrival;
  if (!first && device <= pivot_device_ && pivot_device_ - device < config_.reorder_limit) return to_host(device);

  if (first || device < pivot_device_) restart(device, arrival);
  double x_s = to_seconds(device - origin_device_);
  const auto delay_ns = static_cast<double>(((arrival - origin_host_) - (device - origin_device_)).count());
  const bool device_paused = device - pivot_device_ > config_.most_step;
  const Arrival verdict = judge(x_s, delay_ns, arrival, device_paused ? Duration{0} : paused);
  if (verdict == Arrival::kPlausible) envelope_.add(x_s, delay_ns);
  if (verdict == Arrival::kJump || has_strayed(device, x_s)) {
    restart(device, arrival);
    x_s = 0.0;
    envelope_.add(0.0, 0.0);
  }
  const HostTime target = estimate(device, x_s);
  if (envelope_.count() == 1 && verdict != Arrival::kLate) seat(device, target);
  return follow(device, target);
}

/// The host's time of a datum by the envelope.
HostTime ClockSync::estimate(DeviceTime device, double x_s) const {
  const auto line_ns = Duration{std::llround(envelope_.line().at(x_s))};
  return origin_host_ + (device - origin_device_) + line_ns - config_.min_latency;
}

double ClockSync::gate_ns(double x_s) const {
  return static_cast<double>(config_.jump_threshold.count()) + kGateSigmas * envelope_.line().sigma_at(x_s);
}

/// A trusted output that the estimate has left behind, one small step after another: so it goes when a queue empties that
/// held every datum back.
bool ClockSync::has_strayed(DeviceTime device, double x_s) const {
  if (!locked_) return false;
  const auto error_ns = static_cast<double>((estimate(device, x_s) - to_host(device)).count());
  return std::abs(error_ns) > gate_ns(x_s);
}

/// A datum before its time is a jump; one that is late may be a queue that empties soon, or a jump when it does not.
/// paused: since the arrival before, where the device did not pause as well.
ClockSync::Arrival ClockSync::judge(double x_s, double delay_ns, HostTime arrival, Duration paused) {
  if (envelope_.count() == 0) return Arrival::kPlausible;
  const double excess_ns = delay_ns - envelope_.line().at(x_s);
  if (excess_ns < -gate_ns(x_s)) return Arrival::kJump;
  if (excess_ns < gate_ns(x_s)) {
    late_count_ = 0;
    return Arrival::kPlausible;
  }
  if (late_count_++ == 0) {
    late_since_ = arrival;
    held_ = is_held(excess_ns, paused);
  }
  const Duration patience = held_ ? config_.most_hold : config_.jump_confirm;
  const bool persists = late_count_ >= kFewestLate && arrival - late_since_ >= patience;
  return persists ? Arrival::kJump : Arrival::kLate;
}

/// Whether arrivals paused while the device's stamps ran on without one missing: something on the way holds the data back, and
/// the clocks are as they were. A clock that steps does so between two data that arrive one soon after the other.
bool ClockSync::is_held(double excess_ns, Duration paused) const {
  return excess_ns < static_cast<double>(config_.most_held.count()) && static_cast<double>(paused.count()) > 0.5 * excess_ns;
}

/// Begins a new envelope at this datum. Counted when a mapping that was trusted ends, not while it was still found.
void ClockSync::restart(DeviceTime device, HostTime arrival) {
  if (locked_ || (started_ && device < pivot_device_)) ++jumps_;
  envelope_.restart();
  origin_device_ = device;
  origin_host_ = arrival;
  late_count_ = 0;
  locked_ = false;
}

/// Puts the output line to a new place: forward at once, backward only when slowing down would take too long.
void ClockSync::seat(DeviceTime device, HostTime target) {
  const bool ahead = started_ && pivot_host_ >= target && pivot_host_ - target < config_.reorder_limit;
  pivot_host_ = ahead ? pivot_host_ + kSmallestTick : target;
  pivot_device_ = device;
  started_ = true;
}

/// Moves the output line towards the estimate as fast as the limits allow, and returns the output.
HostTime ClockSync::follow(DeviceTime device, HostTime target) {
  const auto elapsed_ns = static_cast<double>((device - pivot_device_).count());
  const HostTime predicted = to_host(device);
  const auto error_ns = static_cast<double>((target - predicted).count());
  double limit_ns = elapsed_ns * 1e-6 * (locked_ ? config_.slew_ppm : config_.acquire_slew_ppm);
  if (locked_) limit_ns = std::min(limit_ns, static_cast<double>(config_.max_step.count()));
  const double step_ns = std::clamp(error_ns, -limit_ns, limit_ns);

  pivot_host_ = predicted + Duration{std::llround(step_ns)};
  pivot_device_ = device;
  rate_ = 1.0 + envelope_.line().skew;
  slew_left_ns_ = error_ns - step_ns;
  locked_ = locked_ || sigma() < config_.lock_sigma;
  return pivot_host_;
}

DeviceTime CounterUnwrapper::unwrap(Duration counter, HostTime arrival) {
  DeviceTime unwrapped{counter};
  if (started_) {
    const Duration ahead = (last_ + (arrival - last_arrival_)) - unwrapped;
    const double periods = std::round(static_cast<double>(ahead.count()) / static_cast<double>(period_.count()));
    unwrapped += static_cast<std::int64_t>(periods) * period_;
  }
  started_ = true;
  last_ = unwrapped;
  last_arrival_ = arrival;
  return unwrapped;
}

}  // namespace slamd
