#include "daemon/server/pose_publisher.hpp"

#include <sys/eventfd.h>

#include <algorithm>
#include <utility>

#include "daemon/ring/nonblocking.hpp"

namespace slamd {
namespace {

void copy_pose(const Pose& pose, std::array<double, 3>& position_m, std::array<double, 4>& rotation_xyzw) {
  std::copy_n(pose.translation.data(), 3, position_m.begin());
  std::copy_n(pose.rotation.coeffs().data(), 4, rotation_xyzw.begin());  // Eigen keeps x, y, z, w
}

}  // namespace

Result<PosePublisher> PosePublisher::create(UniqueFd kept_page) {
  std::optional<PosePageWriter> kept = PosePageWriter::adopt(std::move(kept_page));
  std::optional<PosePageWriter> page = kept ? std::move(kept) : PosePageWriter::create();
  if (!page) return Error{"no memory file for the pose page (memfd with sealing, and /proc)"};
  UniqueFd wake{::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)};
  if (!wake) return Error{"no eventfd"};
  return PosePublisher{std::move(*page), std::move(wake)};
}

void PosePublisher::publish(const NavState& state, const Pose& T_map_odom, std::int64_t utc_offset_ns) {
  const bool moved = T_map_odom.translation != T_map_odom_.translation ||
                     T_map_odom.rotation.coeffs() != T_map_odom_.rotation.coeffs();
  if (moved) ++map_corrections_;
  T_map_odom_ = T_map_odom;

  PoseSample sample;
  sample.host_time_ns = to_ns(state.time);
  sample.utc_offset_ns = utc_offset_ns;
  sample.sequence = ++sequence_;
  copy_pose(T_map_odom * state.T_odom_base, sample.map_position_m, sample.map_rotation_xyzw);
  copy_pose(state.T_odom_base, sample.odom_position_m, sample.odom_rotation_xyzw);
  std::copy_n(state.velocity_mps.data(), 3, sample.velocity_mps.begin());
  std::copy_n(state.angular_velocity_rads.data(), 3, sample.angular_velocity_rads.begin());
  std::copy_n(state.covariance.data(), 36, sample.covariance.begin());  // symmetric: row-major is column-major
  std::copy_n(state.degenerate_direction.data(), 3, sample.degenerate_direction.begin());
  sample.status = static_cast<std::uint32_t>(state.status);
  sample.reasons = state.reasons;
  sample.lidar_test_ratio = state.lidar_test_ratio;
  sample.map_corrections = map_corrections_;
  page_.write(sample);

  const std::uint64_t one = 1;
  // A full counter (EAGAIN) means that the server has not read 2^64 wake-ups: it is awake already.
  const NonblockingByKnowledge eventfd;  // EFD_NONBLOCK
  [[maybe_unused]] const ssize_t written = ::write(wake_.get(), &one, sizeof one);
}

}  // namespace slamd
