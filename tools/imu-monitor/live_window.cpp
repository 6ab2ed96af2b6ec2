#include "tools/imu-monitor/live_window.hpp"

#include <cstdio>
#include <numeric>

namespace slamd::monitor {
namespace {

constexpr double kStillGyroRads = 0.01;
constexpr double kStillAccelMps2 = 0.15;

}  // namespace

void Spread::add(const Eigen::Vector3d& sample) {
  ++count_;
  const Eigen::Vector3d before = sample - mean_;
  mean_ += before / static_cast<double>(count_);
  squares_ += before.cwiseProduct(sample - mean_);
}

Eigen::Vector3d Spread::deviation() const {
  if (count_ < 2) return Eigen::Vector3d::Zero();
  return (squares_ / static_cast<double>(count_ - 1)).cwiseSqrt();
}

void LiveWindow::add(const ImuSample& sample) {
  ++samples_;
  temperature_sum_ += sample.temperature_c;
  gyro_.add(sample.gyro_rads);
  accel_.add(sample.accel_mps2);
}

void LiveWindow::add(const ImuFrame& frame) {
  if (frames_ == 0) first_us_ = frame.device_us;
  last_us_ = frame.device_us;
  ++frames_;
}

double LiveWindow::rate_hz() const {
  if (last_us_ <= first_us_) return 0.0;
  return static_cast<double>(frames_ - 1) * 1e6 / static_cast<double>(last_us_ - first_us_);
}

bool LiveWindow::is_at_rest() const {
  return gyro_.deviation().maxCoeff() < kStillGyroRads && accel_.deviation().maxCoeff() < kStillAccelMps2;
}

std::string live_line(const LiveWindow& window, const ImuFrameParser& parser) {
  const ImuStats& stats = parser.stats();
  const ClockSync& clock = parser.clock();
  const std::uint64_t rejected = std::accumulate(stats.rejected.begin(), stats.rejected.end(), std::uint64_t{0});
  const Eigen::Vector3d gyro = window.gyro().deviation();
  const Eigen::Vector3d accel = window.accel().deviation();
  char text[400];
  std::snprintf(text, sizeof text,
                "%6.1f Hz  gaps %llu (%llu missing)  rejected %llu  resets %llu  faults %llu  skew %+.2f +- %.2f ppm  "
                "|g| %.4f m/s^2  %.1f C  std gyro %.5f %.5f %.5f rad/s  accel %.4f %.4f %.4f m/s^2%s",
                window.rate_hz(), static_cast<unsigned long long>(stats.gaps),
                static_cast<unsigned long long>(stats.missing), static_cast<unsigned long long>(rejected),
                static_cast<unsigned long long>(stats.resets), static_cast<unsigned long long>(stats.sensor_faults),
                clock.skew_ppm(), clock.skew_sigma_ppm(), window.gravity_mps2(), window.temperature_c(), gyro.x(),
                gyro.y(), gyro.z(), accel.x(), accel.y(), accel.z(), window.is_at_rest() ? "" : "  moving");
  return text;
}

}  // namespace slamd::monitor
