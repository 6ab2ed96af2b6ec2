#include "drivers/velodyne/vlp16_timeline.hpp"

#include <chrono>
#include <cmath>

#include "drivers/velodyne/vlp16_timing.hpp"

namespace slamd {
namespace {

constexpr Duration kHour = std::chrono::hours{1};
constexpr Duration kRecent = std::chrono::milliseconds{20};  // beyond it the rate no longer predicts the azimuth
constexpr float kAzimuthToleranceCdeg = 100.0F;
constexpr float kAzimuthToleranceShare = 0.05F;  // of the advance

Duration magnitude(Duration d) {
  return d < Duration::zero() ? -d : d;
}

/// The time congruent to `past_hour` that is nearest to `expected`.
DeviceTime unwrap(Duration past_hour, DeviceTime expected) {
  Duration ahead = (past_hour - expected.time_since_epoch()) % kHour;
  if (ahead > kHour / 2) ahead -= kHour;
  if (ahead < -kHour / 2) ahead += kHour;
  return expected + ahead;
}

bool azimuth_continues(const Vlp16Arrival& before, const Vlp16Arrival& now) {
  const Duration advance = now.begin - before.begin;
  if (advance > kRecent) return true;
  const float turned = before.rate_cdeg_per_ns * static_cast<float>(advance.count());
  const float error = azimuth_difference_cdeg(now.azimuth_cdeg, before.azimuth_cdeg + turned);
  return std::abs(error) <= kAzimuthToleranceCdeg + kAzimuthToleranceShare * turned;
}

std::uint64_t packets_between(Duration advance, Duration span) {
  return advance > span + span / 2 ? static_cast<std::uint64_t>((advance + span / 2) / span - 1) : 0;
}

}  // namespace

bool Vlp16Timeline::continues(const Vlp16Arrival& before, const Vlp16Arrival& now) const {
  const Duration elapsed = now.arrival - before.arrival;
  const Duration drift = magnitude(elapsed) / 1000;  // clocks that differ by more than 0.1 % are broken
  return magnitude((now.begin - before.begin) - elapsed) <= tolerance_ + drift;
}

Vlp16Admission Vlp16Timeline::admit(std::uint32_t stamp_us, Duration span, HostTime arrival,
                                    const Vlp16Rotation& rotation) {
  const Duration past_hour = std::chrono::microseconds{stamp_us};
  const DeviceTime expected = last_ ? last_->begin + (arrival - last_->arrival) : DeviceTime{past_hour};
  const float rate = rotation.mean_step_cdeg / static_cast<float>(kVlp16Block.count());
  const Vlp16Arrival now{unwrap(past_hour, expected), arrival, static_cast<float>(rotation.azimuth_cdeg[0]), rate};
  Vlp16Admission admission{Vlp16Rejection::kCount, now.begin, 0, false};

  if (last_ && !continues(*last_, now)) {
    admission.jumped = doubtful_ && continues(*doubtful_, now) && now.begin > doubtful_->begin;
    if (!admission.jumped) {
      doubtful_ = now;
      admission.cause = Vlp16Rejection::kStampJump;
      return admission;
    }
  } else if (last_ && now.begin <= last_->begin) {
    admission.cause = Vlp16Rejection::kOutOfOrder;
    return admission;
  } else if (last_ && !azimuth_continues(*last_, now)) {
    admission.cause = Vlp16Rejection::kAzimuthJump;
    return admission;
  } else if (last_) {
    admission.lost_packets = packets_between(now.begin - last_->begin, span);
  }
  last_ = now;
  doubtful_.reset();
  return admission;
}

}  // namespace slamd
