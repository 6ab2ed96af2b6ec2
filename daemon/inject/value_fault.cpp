#include "daemon/inject/value_fault.hpp"

#include <cmath>

namespace slamd {
namespace {

constexpr std::size_t kMostPackets = 320;  // of a revolution: dual returns at 300 rpm
constexpr int kTurn_cdeg = 36000;

int degrees_turned(std::uint16_t from_cdeg, std::uint16_t to_cdeg) {
  return (int{to_cdeg} - int{from_cdeg} + kTurn_cdeg) % kTurn_cdeg;
}

}  // namespace

std::optional<ImuSample> ImuValueFault::apply(const ImuSample& sample) {
  const FaultVerb verb = verbs_.verb(sample.arrival);
  if (verb != FaultVerb::kStuck) stuck_.reset();
  if (verb == FaultVerb::kSlow && !slow_.lets_through()) return std::nullopt;
  ImuSample given = sample;
  if (verb == FaultVerb::kStuck) {
    if (!stuck_) stuck_ = sample;
    given.gyro_rads = stuck_->gyro_rads;
    given.accel_mps2 = stuck_->accel_mps2;
  } else if (verb == FaultVerb::kWrong) {
    given.gyro_rads.z() += 0.3;
    given.accel_mps2.x() += 2.0;
  }
  return given;
}

std::optional<GnssFix> GnssValueFault::apply(const GnssFix& fix) {
  constexpr double kEast_m = 50.0;
  constexpr double kMoving_mps = 1.0;
  constexpr double kMetresPerDegree = 111'320.0;  // of longitude on the equator
  const FaultVerb verb = verbs_.verb(fix.arrival);
  if (verb != FaultVerb::kStuck) stuck_.reset();
  if (verb == FaultVerb::kSlow && !slow_.lets_through()) return std::nullopt;
  GnssFix given = fix;
  if (verb == FaultVerb::kStuck) {
    const bool repeats = stuck_.has_value();
    if (!repeats) stuck_ = fix;
    given = *stuck_;
    given.stale = repeats && stuck_->speed_mps > kMoving_mps;  // as the parser marks a position that stays while the vehicle moves
    given.time = fix.time;
    given.arrival = fix.arrival;
    given.utc = fix.utc;
  } else if (verb == FaultVerb::kWrong) {
    given.longitude_deg += kEast_m / (kMetresPerDegree * std::cos(fix.latitude_deg * M_PI / 180.0));
  }
  return given;
}

LidarValueFault::LidarValueFault(const FaultSwitch& verbs) : verbs_{verbs}, picture_(kMostPackets) {}

const LidarPacket* LidarValueFault::apply(const LidarPacket& packet) {
  const FaultVerb verb = verbs_.verb(packet.arrival);
  if (verb == FaultVerb::kStuck) return stuck(packet);
  forget_picture();
  if (verb == FaultVerb::kWrong) return wrong(packet);
  return verb == FaultVerb::kSlow && !slow_.lets_through() ? nullptr : &packet;
}

const LidarPacket* LidarValueFault::stuck(const LidarPacket& packet) {
  const std::uint16_t begin_cdeg = picture_[0].azimuth_begin_cdeg;
  if (!complete_ && taken_ > 1) {
    const int turned = degrees_turned(begin_cdeg, packet.azimuth_begin_cdeg);
    complete_ = turned < degrees_turned(begin_cdeg, picture_[taken_ - 1].azimuth_begin_cdeg) || taken_ == kMostPackets;
  }
  if (!complete_) {
    picture_[taken_++] = packet;
    return &packet;
  }
  changed_ = picture_[next_];
  next_ = (next_ + 1) % taken_;
  changed_.time = packet.time;
  changed_.arrival = packet.arrival;
  changed_.clock_unsure = packet.clock_unsure;
  return &changed_;
}

const LidarPacket* LidarValueFault::wrong(const LidarPacket& packet) {
  constexpr float kTooLong = 1.2F;
  changed_ = packet;
  for (std::size_t i = 0; i < changed_.point_count; ++i) {
    LidarPoint& point = changed_.points[i];
    point.x *= kTooLong;
    point.y *= kTooLong;
    point.z *= kTooLong;
  }
  return &changed_;
}

void LidarValueFault::forget_picture() {
  taken_ = next_ = 0;
  complete_ = false;
}

}  // namespace slamd
