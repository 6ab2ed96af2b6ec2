#include "estimator/odometry/imu_buffer.hpp"

namespace slamd {

bool ImuBuffer::push(const ImuSample& sample) {
  if (!empty() && sample.time <= newest().time) return false;
  if (count_ == kCapacity) {
    first_ = (first_ + 1) % kCapacity;
    --count_;
  }
  samples_[(first_ + count_) % kCapacity] = sample;
  ++count_;
  return true;
}

std::size_t ImuBuffer::first_after(HostTime t) const {
  std::size_t low = 0;
  std::size_t high = count_;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if ((*this)[middle].time > t) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

ImuSample ImuBuffer::at(HostTime t) const {
  const std::size_t after = first_after(t);
  if (after == 0) return (*this)[0];
  const ImuSample& a = (*this)[after - 1];
  if (after == count_ || a.time == t) return a;
  const ImuSample& b = (*this)[after];
  const double share = to_seconds(t - a.time) / to_seconds(b.time - a.time);
  ImuSample out = a;
  out.time = t;
  out.gyro_rads += share * (b.gyro_rads - a.gyro_rads);
  out.accel_mps2 += share * (b.accel_mps2 - a.accel_mps2);
  out.clipped = a.clipped || b.clipped;
  return out;
}

}  // namespace slamd
