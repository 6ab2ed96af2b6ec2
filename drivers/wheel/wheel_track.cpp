#include "drivers/wheel/wheel_track.hpp"

#include <cmath>
#include <numbers>

namespace slamd {
namespace {

/// Nearest to zero of the angles that are the same on the circle: devices may wrap their yaw.
double turn_rad(const WheelReading& from, const WheelReading& to) {
  return std::remainder(to.yaw_rad - from.yaw_rad, 2.0 * std::numbers::pi);
}

}  // namespace

const char* name(WheelRejection cause) {
  switch (cause) {
    case WheelRejection::kImpossible: return "impossible";
    case WheelRejection::kRepeated: return "repeated";
    case WheelRejection::kDoubtful: return "doubtful";
    case WheelRejection::kCount: break;
  }
  return "none";
}

WheelTrackConfig WheelTrackConfig::defaults() {
  WheelTrackConfig config;
  config.clock.min_latency = std::chrono::milliseconds{1};
  config.clock.envelope.expected_jitter_s = 2e-3;
  return config;
}

bool WheelTrack::follows(const Placed& earlier, const Placed& later) const {
  const Duration passed = later.device - earlier.device;
  if (passed <= Duration::zero() || abs(passed - (later.arrival - earlier.arrival)) > config_.stamp_tolerance) return false;
  const double step_m = std::hypot(later.reading.x_m - earlier.reading.x_m, later.reading.y_m - earlier.reading.y_m);
  return step_m <= config_.most_speed_mps * to_seconds(passed) + config_.slack_m &&
         std::abs(turn_rad(earlier.reading, later.reading)) <= config_.most_rate_rads * to_seconds(passed) + config_.slack_rad;
}

std::optional<WheelOdometry> WheelTrack::refuse(WheelRejection cause) {
  stats_.rejections.add(cause);
  return std::nullopt;
}

/// Moves the pose that is given out by what the device's went from one reading to the other.
void WheelTrack::carry_on(const WheelReading& from, const WheelReading& to) {
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  const double c = std::cos(frame_yaw_rad_);
  const double s = std::sin(frame_yaw_rad_);
  out_.x_m += c * dx - s * dy;
  out_.y_m += s * dx + c * dy;
  out_.yaw_rad += turn_rad(from, to);
}

std::optional<WheelOdometry> WheelTrack::add(const WheelReading& reading, HostTime arrival) {
  if (!is_possible(reading)) return refuse(WheelRejection::kImpossible);
  const Placed now{reading, counter_.unwrap(std::chrono::microseconds{reading.device_us}, arrival), arrival};
  if (last_ && now.device == last_->device) return refuse(WheelRejection::kRepeated);
  if (last_ && !follows(*last_, now)) {
    if (!doubtful_ || !follows(*doubtful_, now)) {
      doubtful_ = now;
      return refuse(WheelRejection::kDoubtful);
    }
    ++stats_.restarts;
    last_ = doubtful_;
    frame_yaw_rad_ = out_.yaw_rad - last_->reading.yaw_rad;
  }
  if (last_) {
    carry_on(last_->reading, reading);
  } else {
    out_.x_m = reading.x_m;
    out_.y_m = reading.y_m;
    out_.yaw_rad = reading.yaw_rad;
  }
  doubtful_.reset();
  last_ = now;
  out_.time = clock_.update(now.device, arrival);
  out_.arrival = arrival;
  ++stats_.accepted;
  return out_;
}

}  // namespace slamd
