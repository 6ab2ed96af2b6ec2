#include "tools/slam-replay/output.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <iomanip>

namespace slamd::replay {

namespace {

void write_time(std::ostream& out, HostTime time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%lld.%09lld", static_cast<long long>(to_ns(time) / kSecond),
                static_cast<long long>(to_ns(time) % kSecond));
  out << text.data();
}

void write_upper(std::ostream& out, const Matrix6d& covariance) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) out << ',' << covariance(i, j);
  }
  out << '\n';
}

}  // namespace

void write_tum(std::ostream& out, HostTime time, const Pose& T_odom_base) {
  write_time(out, time);
  const Eigen::Vector3d& t = T_odom_base.translation;
  const Eigen::Quaterniond& q = T_odom_base.rotation;
  std::array<char, 240> text;
  std::snprintf(text.data(), text.size(), " %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", t.x(), t.y(), t.z(), q.x(), q.y(),
                q.z(), q.w());
  out << text.data();
}

Output::Output(const std::string& folder) : folder_{folder} {
  std::error_code ignored;  // a folder that cannot be made shows in the files
  std::filesystem::create_directories(folder, ignored);
  odom_.open(path("odom.tum"));
  imu_rate_.open(path("imu_rate.tum"));
  covariance_.open(path("covariance.csv"));
  keyframes_.open(path("keyframes.csv"));
}

void Output::scan(const NavState& state) {
  write_tum(odom_, state.time, state.T_odom_base);
  write_time(covariance_, state.time);
  write_upper(covariance_, state.covariance);
}

void Output::keyframe(const Keyframe& keyframe) {
  write_time(keyframes_, keyframe.state.time);
  const Eigen::Vector3d& up = keyframe.up_base;
  keyframes_ << std::setprecision(9) << ',' << up.x() << ',' << up.y() << ',' << up.z() << std::setprecision(6) << ','
             << keyframe.up_sigma_rad;
  write_upper(keyframes_, keyframe.relative_covariance);
}

void Output::imu_rate(const NavState& state) { write_tum(imu_rate_, state.time, state.T_odom_base); }

bool Output::finish() {
  odom_.flush();
  imu_rate_.flush();
  covariance_.flush();
  keyframes_.flush();
  return odom_.good() && imu_rate_.good() && covariance_.good() && keyframes_.good();
}

}  // namespace slamd::replay
