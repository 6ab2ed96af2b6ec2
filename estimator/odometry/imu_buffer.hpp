#pragma once
// The newest IMU samples in order of time, and their division into intervals that end exactly where a scan ends.

#include <array>
#include <cstdint>

#include "estimator/types/imu_sample.hpp"

namespace slamd {

class ImuBuffer {
 public:
  static constexpr std::size_t kCapacity = 2'048;  // 10 s at 200 Hz; older samples are overwritten

  /// False and nothing stored when the sample is not younger than the newest one.
  bool push(const ImuSample& sample);
  void clear() { first_ = count_ = 0; }
  /// Forgets the samples younger than t.
  void drop_after(HostTime t) { count_ = first_after(t); }

  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  const ImuSample& operator[](std::size_t i) const { return samples_[(first_ + i) % kCapacity]; }
  const ImuSample& newest() const { return (*this)[count_ - 1]; }

  /// Index of the first sample with time > t; size() when there is none.
  std::size_t first_after(HostTime t) const;
  /// Linear interpolation at t; the nearest sample's values outside of all. Not on an empty buffer.
  ImuSample at(HostTime t) const;

 private:
  std::array<ImuSample, kCapacity> samples_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

/// One piece of time between `from` and `to` of walk(): with the mean of its end samples, or without any (a gap).
struct ImuPiece {
  HostTime from, to;
  Eigen::Vector3d gyro_rads = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_mps2 = Eigen::Vector3d::Zero();
  bool measured = false;
  bool clipped = false;
};

/// Calls visit(ImuPiece) for the pieces of (from, to] in order. Where two samples are more than max_gap apart, or there
/// are none, the pieces are not measured and 10 ms long, longer where that would make more than 200 of them.
template <class Visit>
void walk(const ImuBuffer& buffer, HostTime from, HostTime to, Duration max_gap, Visit&& visit) {
  constexpr int kMostCoastSteps = 200;
  const Duration coast_step = std::max<Duration>(std::chrono::milliseconds{10}, (to - from) / kMostCoastSteps);
  std::size_t next = buffer.first_after(from);
  while (from < to) {
    const bool has_next = next < buffer.size();
    const HostTime piece_end = has_next ? std::min(buffer[next].time, to) : to;
    const bool has_last = next > 0;
    const bool near = has_next && has_last ? buffer[next].time - buffer[next - 1].time <= max_gap
                                           : has_last && to - buffer[next - 1].time <= max_gap;
    ImuPiece piece{.from = from, .to = piece_end};
    if (near) {
      const ImuSample begin = buffer.at(from);
      const ImuSample end = buffer.at(piece_end);
      piece.gyro_rads = 0.5 * (begin.gyro_rads + end.gyro_rads);
      piece.accel_mps2 = 0.5 * (begin.accel_mps2 + end.accel_mps2);
      piece.measured = true;
      piece.clipped = begin.clipped || end.clipped;
    } else {
      piece.to = std::min(piece_end, from + coast_step);
    }
    visit(piece);
    from = piece.to;
    if (has_next && from >= buffer[next].time) ++next;
  }
}

}  // namespace slamd
