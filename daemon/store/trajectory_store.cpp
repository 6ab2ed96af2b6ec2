#include "daemon/store/trajectory_store.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace slamd {

TrajectoryStore::TrajectoryStore(std::size_t capacity) : capacity_{std::max<std::size_t>(capacity, 2)} {
  poses_.reserve(capacity_);
}

void TrajectoryStore::add(HostTime time, const Pose& T_odom_base) {
  const std::lock_guard lock{mutex_};
  const bool finite = T_odom_base.translation.allFinite() && T_odom_base.rotation.coeffs().allFinite();
  if (!finite || (!poses_.empty() && time <= poses_.back().time)) {
    ++rejected_;
    return;
  }
  if (newest_is_extra_) poses_.pop_back();
  if (poses_.size() == capacity_) thin_out();
  poses_.push_back({time, T_odom_base});
  newest_is_extra_ = added_ % stride_ != 0;
  ++added_;
}

void TrajectoryStore::thin_out() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < poses_.size(); i += 2) poses_[kept++] = poses_[i];
  poses_.resize(kept);
  stride_ *= 2;
}

std::vector<StampedPose> TrajectoryStore::snapshot(std::size_t max_poses) const {
  const std::lock_guard lock{mutex_};
  if (poses_.size() <= max_poses) return poses_;
  std::vector<StampedPose> chosen;
  if (max_poses == 0) return chosen;
  if (max_poses == 1) return {poses_.back()};
  chosen.reserve(max_poses);
  for (std::size_t i = 0; i < max_poses; ++i) chosen.push_back(poses_[i * (poses_.size() - 1) / (max_poses - 1)]);
  return chosen;
}

std::size_t TrajectoryStore::size() const {
  const std::lock_guard lock{mutex_};
  return poses_.size();
}

std::uint64_t TrajectoryStore::stride() const {
  const std::lock_guard lock{mutex_};
  return stride_;
}

std::uint64_t TrajectoryStore::rejected() const {
  const std::lock_guard lock{mutex_};
  return rejected_;
}

std::string to_tum(const std::vector<StampedPose>& poses) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  std::string text;
  text.reserve(poses.size() * 110);
  std::array<char, 256> line{};
  for (const StampedPose& pose : poses) {
    const std::int64_t ns = to_ns(pose.time);
    const Eigen::Vector3d& p = pose.T_odom_base.translation;
    const Eigen::Quaterniond& q = pose.T_odom_base.rotation;
    const int length = std::snprintf(line.data(), line.size(), "%lld.%09lld %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n",
                                     static_cast<long long>(ns / kNsPerSecond), static_cast<long long>(ns % kNsPerSecond),
                                     p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
    text.append(line.data(), static_cast<std::size_t>(std::min<int>(length, line.size() - 1)));
  }
  return text;
}

}  // namespace slamd
