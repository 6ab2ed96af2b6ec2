#include "tools/slam-replay/output.hpp"

#include <array>
#include <cstdio>
#include <filesystem>

namespace slamd::replay {

namespace {

void write_time(std::ostream& out, HostTime time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%lld.%09lld", static_cast<long long>(to_ns(time) / kSecond),
                static_cast<long long>(to_ns(time) % kSecond));
  out << text.data();
}

}  // namespace

void write_tum(std::ostream& out, HostTime time, const Pose& T_odom_base) {
  write_time(out, time);
  const Eigen::Vector3d& t = T_odom_base.translation;
  const Eigen::Quaterniond& q = T_odom_base.rotation;
  std::array<char, 160> text;
  std::snprintf(text.data(), text.size(), " %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", t.x(), t.y(), t.z(), q.x(), q.y(),
                q.z(), q.w());
  out << text.data();
}

Output::Output(const std::string& folder) : folder_{folder} {
  std::error_code ignored;  // a folder that cannot be made shows in the files
  std::filesystem::create_directories(folder, ignored);
  odom_.open(path("odom.tum"));
  imu_rate_.open(path("imu_rate.tum"));
  covariance_.open(path("covariance.csv"));
}

void Output::scan(const NavState& state) {
  write_tum(odom_, state.time, state.T_odom_base);
  write_time(covariance_, state.time);
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) covariance_ << ',' << state.covariance(i, j);
  }
  covariance_ << '\n';
}

void Output::imu_rate(const NavState& state) { write_tum(imu_rate_, state.time, state.T_odom_base); }

bool Output::finish() {
  odom_.flush();
  imu_rate_.flush();
  covariance_.flush();
  return odom_.good() && imu_rate_.good() && covariance_.good();
}

}  // namespace slamd::replay
