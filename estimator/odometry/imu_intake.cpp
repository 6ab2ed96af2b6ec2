#include "estimator/odometry/imu_intake.hpp"

namespace slamd {

bool ImuIntake::add(const ImuSample& sample) {
  if (!sample.gyro_rads.allFinite() || !sample.accel_mps2.allFinite()) {
    ++stats_.not_finite;
    return false;
  }
  if (sample.time > sample.arrival + kMostAhead) {
    ++stats_.in_future;
    clock_doubt_.raise(sample.arrival);
    return false;
  }
  if (!is_in_order(sample)) {
    ++stats_.out_of_order;
    return false;
  }
  newest_ = sample.time;
  if (sample.clock_unsure) clock_doubt_.raise(sample.arrival);
  const ImuFault fault = sanity_.look(sample);
  if (!sanity_.is_sane()) samples_.drop_after(sanity_.faulty_since());
  if (fault == ImuFault::kNone) return samples_.push(sample);
  ++(fault == ImuFault::kFrozen ? stats_.frozen : stats_.implausible);
  return false;
}

bool ImuIntake::is_in_order(const ImuSample& sample) {
  if (!newest_ || sample.time > *newest_) {
    backward_ = 0;
    return true;
  }
  backward_ = backward_ > 0 && sample.time > newest_backward_ ? backward_ + 1 : 1;
  newest_backward_ = sample.time;
  if (backward_ < kBackwardSamples) return false;
  backward_ = 0;
  samples_.clear();
  sanity_.clear();
  clock_doubt_.raise(sample.arrival);
  ++stats_.clock_restarts;
  return true;
}

bool ImuIntake::is_alive(HostTime at) const {
  return sanity_.is_sane() && !samples_.empty() && at - samples_.newest().time < from_seconds(config_.timeout_s);
}

}  // namespace slamd
