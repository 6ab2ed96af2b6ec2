#include "estimator/odometry/imu_sanity.hpp"

#include <algorithm>

namespace slamd {

namespace {

/// A few samples with equal values happen where an IMU is read faster than it measures.
constexpr std::uint32_t kFewSamples = 5;

}  // namespace

bool ImuSanity::Run::lasts(HostTime now, double seconds) const {
  return length >= kFewSamples && now - since >= from_seconds(seconds);
}

bool ImuSanity::is_suspect() const {
  return std::max(same_gyro_.length, same_accel_.length) >= kFewSamples;
}

bool ImuSanity::is_plausible(const ImuSample& sample) const {
  const double force = sample.accel_mps2.norm();
  return force >= config_.least_force_mps2 && force <= config_.most_force_mps2 &&
         sample.gyro_rads.norm() <= config_.most_turn_rads;
}

const ImuSanity::Run* ImuSanity::fault_at(HostTime now) const {
  if (same_all_.lasts(now, config_.frozen_s)) return &same_all_;
  if (same_gyro_.lasts(now, config_.frozen_part_s)) return &same_gyro_;
  if (same_accel_.lasts(now, config_.frozen_part_s)) return &same_accel_;
  return implausible_.lasts(now, config_.implausible_s) ? &implausible_ : nullptr;
}

ImuFault ImuSanity::look(const ImuSample& sample) {
  const HostTime before = last_ ? last_->time : sample.time;
  const bool same_gyro = last_ && last_->gyro_rads == sample.gyro_rads;
  const bool same_accel = last_ && last_->accel_mps2 == sample.accel_mps2;
  same_gyro_.go_on(same_gyro, before);
  same_accel_.go_on(same_accel, before);
  same_all_.go_on(same_gyro && same_accel, before);
  const bool implausible = !is_plausible(sample);
  implausible_.go_on(implausible, before);
  last_ = sample;

  if (const Run* run = fault_at(sample.time)) {
    if (is_sane()) faulty_since_ = run->since;
    fault_ = run == &implausible_ ? ImuFault::kImplausible : ImuFault::kFrozen;
    last_fault_ = sample.time;
  } else if (sample.time - last_fault_ >= from_seconds(config_.sane_again_s)) {
    fault_ = ImuFault::kNone;
  }
  return is_sane() && implausible ? ImuFault::kImplausible : fault_;
}

}  // namespace slamd
