#include "daemon/health/sensor_monitor.hpp"

#include <algorithm>

namespace slamd {
namespace {

constexpr double kWindow_s = 1.0;
constexpr double kLeak = 0.1;             // seconds of failing that a good second takes back
constexpr double kLongestStart_s = 10.0;  // a device may take so long to wake up; then what is wrong is a defect
constexpr double kMostCreditedGap_s = 1.0;  // between two looks: a judge that slept accuses nobody

/// Without such an item nothing is left of the sensor.
bool is_hard(SensorDefect defect) {
  return defect == SensorDefect::kSilent || defect == SensorDefect::kRefused || defect == SensorDefect::kUnused;
}

bool is_within(const std::optional<HostTime>& instant, HostTime now, double seconds) {
  return instant && to_seconds(now - *instant) <= seconds;
}

double share(std::uint64_t part, std::uint64_t rest) {
  return part == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(part + rest);
}

}  // namespace

const char* name(SensorState state) {
  switch (state) {
    case SensorState::kAbsent: return "absent";
    case SensorState::kStarting: return "starting";
    case SensorState::kHealthy: return "healthy";
    case SensorState::kDegraded: return "degraded";
    case SensorState::kFaulty: return "faulty";
  }
  return "unknown";
}

const char* name(SensorDefect defect) {
  switch (defect) {
    case SensorDefect::kNone: return "none";
    case SensorDefect::kNoDevice: return "no_device";
    case SensorDefect::kSilent: return "silent";
    case SensorDefect::kRefused: return "refused";
    case SensorDefect::kUnused: return "unused";
    case SensorDefect::kNoFix: return "no_fix";
    case SensorDefect::kSlow: return "slow";
    case SensorDefect::kDamaged: return "damaged";
    case SensorDefect::kLossy: return "lossy";
    case SensorDefect::kDoubted: return "doubted";
    case SensorDefect::kUnsureClock: return "unsure_clock";
  }
  return "unknown";
}

const SensorCondition& SensorMonitor::look(const SensorEvidence& evidence, HostTime now) {
  count_window(evidence, now);
  const double elapsed_s = looked_ ? std::min(to_seconds(now - *looked_), kMostCreditedGap_s) : 0.0;
  looked_ = now;
  const SensorDefect defect = defect_of(evidence, now);
  if (defect != SensorDefect::kNone || condition_.state == SensorState::kAbsent) clean_since_ = now;
  failing_s_ = is_hard(defect) ? failing_s_ + elapsed_s : std::max(0.0, failing_s_ - kLeak * elapsed_s);

  const SensorState state = next_state(defect, now);
  const bool changed = state != condition_.state;
  if (changed) {
    condition_.since = now;
    if (state == SensorState::kFaulty) ++condition_.times_faulty;
  }
  if (state != SensorState::kDegraded && state != SensorState::kStarting) failing_s_ = 0.0;
  condition_.state = state;
  const bool told = state == SensorState::kFaulty ? changed : defect != SensorDefect::kNone;
  if (told || state == SensorState::kHealthy) condition_.defect = defect;
  return condition_;
}

/// Judged once a second: rates of shorter times are the sensor's packets rather than the sensor.
void SensorMonitor::count_window(const SensorEvidence& evidence, HostTime now) {
  if (!evidence.present || !window_begin_) {
    last_window_ = SensorDefect::kNone;
  } else {
    const double seconds = to_seconds(now - *window_begin_);
    if (seconds < kWindow_s) return;
    last_window_ = defect_of_counts(evidence, seconds);
  }
  window_ = evidence;
  window_begin_ = now;
}

SensorDefect SensorMonitor::defect_of_counts(const SensorEvidence& evidence, double seconds) const {
  const std::uint64_t good = evidence.good - window_.good;
  if (static_cast<double>(good) < patience_.least_rate_hz * seconds) return SensorDefect::kSlow;
  if (share(evidence.bad - window_.bad, good) > patience_.most_bad_share) return SensorDefect::kDamaged;
  if (share(evidence.lost - window_.lost, good) > patience_.most_bad_share) return SensorDefect::kLossy;
  return SensorDefect::kNone;
}

SensorDefect SensorMonitor::defect_of(const SensorEvidence& evidence, HostTime now) const {
  if (!evidence.present) return SensorDefect::kNoDevice;
  if (!is_within(evidence.good_at, now, patience_.late_s)) {
    if (is_within(evidence.spoke, now, patience_.late_s)) return SensorDefect::kNoFix;
    return is_within(evidence.heard, now, patience_.late_s) ? SensorDefect::kRefused : SensorDefect::kSilent;
  }
  if (evidence.use == SensorEvidence::Use::kRefused) return SensorDefect::kUnused;
  if (last_window_ != SensorDefect::kNone) return last_window_;
  if (evidence.use == SensorEvidence::Use::kDoubted) return SensorDefect::kDoubted;
  return evidence.clock_sure ? SensorDefect::kNone : SensorDefect::kUnsureClock;
}

SensorState SensorMonitor::next_state(SensorDefect defect, HostTime now) const {
  if (defect == SensorDefect::kNoDevice) return SensorState::kAbsent;
  const double lasts_s = to_seconds(now - condition_.since);
  const bool may_start = condition_.state == SensorState::kStarting && lasts_s < kLongestStart_s;
  if (failing_s_ >= patience_.faulty_s && !may_start) return SensorState::kFaulty;
  const double clean_s = defect == SensorDefect::kNone ? to_seconds(now - clean_since_) : 0.0;
  switch (condition_.state) {
    case SensorState::kAbsent: return SensorState::kStarting;
    case SensorState::kHealthy: return defect == SensorDefect::kNone ? SensorState::kHealthy : SensorState::kDegraded;
    case SensorState::kFaulty: return clean_s >= patience_.clean_s ? SensorState::kHealthy : SensorState::kFaulty;
    case SensorState::kStarting:
    case SensorState::kDegraded: break;
  }
  if (clean_s >= patience_.proving_s) return SensorState::kHealthy;
  return lasts_s >= kLongestStart_s ? SensorState::kDegraded : condition_.state;
}

}  // namespace slamd
