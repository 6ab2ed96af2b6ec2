#pragma once
// What the stream did during one line of imu-monitor: rate, noise, temperature, gravity. It reads no port.

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "drivers/imu/imu_frame_parser.hpp"

namespace slamd::monitor {

/// Mean and deviation of a vector, one sample at a time (Welford).
class Spread {
 public:
  void add(const Eigen::Vector3d& sample);
  const Eigen::Vector3d& mean() const { return mean_; }
  /// Of each axis; zero for fewer than two samples.
  Eigen::Vector3d deviation() const;

 private:
  std::uint64_t count_ = 0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares_ = Eigen::Vector3d::Zero();
};

class LiveWindow {
 public:
  /// One sample as the parser gave it, and one frame as it stood in the stream: only that has the board's own time.
  void add(const ImuSample& sample);
  void add(const ImuFrame& frame);

  std::uint64_t samples() const { return samples_; }
  /// Frames per second of the board's clock; 0 for fewer than two frames, or when it started anew in between.
  double rate_hz() const;
  const Spread& gyro() const { return gyro_; }
  const Spread& accel() const { return accel_; }
  double gravity_mps2() const { return accel_.mean().norm(); }
  double temperature_c() const { return samples_ > 0 ? temperature_sum_ / static_cast<double>(samples_) : 0.0; }
  /// All axes as quiet as a board that lies still: their deviations then are its noise.
  bool is_at_rest() const;

 private:
  std::uint64_t samples_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t first_us_ = 0;
  std::uint64_t last_us_ = 0;
  double temperature_sum_ = 0.0;
  Spread gyro_;
  Spread accel_;
};

/// One line for people, of the window and the totals of the parser so far.
std::string live_line(const LiveWindow& window, const ImuFrameParser& parser);

}  // namespace slamd::monitor
