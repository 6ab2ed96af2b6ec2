#include "drivers/io/packet_timeline.hpp"

#include <chrono>
#include <cmath>

#include "drivers/io/head_rotation.hpp"

namespace slamd {
namespace {

constexpr Duration kRecent = std::chrono::milliseconds{20};  // beyond it the rate no longer predicts the azimuth
constexpr float kAzimuthToleranceCdeg = 100.0F;
constexpr float kAzimuthToleranceShare = 0.05F;  // of the advance

bool azimuth_continues(const PacketMoment& before, const PacketMoment& now) {
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

std::optional<DeviceTime> PacketTimeline::expected(HostTime arrival) const {
  if (!last_) return std::nullopt;
  return last_->begin + (arrival - last_->arrival);
}

bool PacketTimeline::continues(const PacketMoment& before, const PacketMoment& now) const {
  const Duration elapsed = now.arrival - before.arrival;
  const Duration drift = abs(elapsed) / 1000;  // clocks that differ by more than 0.1 % are broken
  return abs((now.begin - before.begin) - elapsed) <= tolerance_ + drift;
}

PacketAdmission PacketTimeline::admit(const PacketMoment& now, Duration span) {
  PacketAdmission admission;
  if (last_ && !continues(*last_, now)) {
    admission.jumped = doubtful_ && continues(*doubtful_, now) && now.begin > doubtful_->begin;
    if (!admission.jumped) {
      doubtful_ = now;
      admission.verdict = PacketVerdict::kStampJump;
      return admission;
    }
  } else if (last_ && now.begin <= last_->begin) {
    admission.verdict = PacketVerdict::kOutOfOrder;
    return admission;
  } else if (last_ && !azimuth_continues(*last_, now)) {
    admission.verdict = PacketVerdict::kAzimuthJump;
    return admission;
  } else if (last_) {
    admission.lost_packets = packets_between(now.begin - last_->begin, span);
  }
  last_ = now;
  doubtful_.reset();
  return admission;
}

}  // namespace slamd
