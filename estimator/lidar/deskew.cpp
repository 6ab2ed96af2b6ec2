#include "estimator/lidar/deskew.hpp"

#include <algorithm>

#include "estimator/math/lie.hpp"

namespace slamd {

void ScanMotion::add(double time_s, const Pose& T_odom_imu) {
  if (knots_.size() < knots_.capacity()) knots_.push_back({time_s, T_odom_imu});
}

void ScanMotion::bend(const Pose& T_end_corrected) {
  if (knots_.size() < 2) return;
  const double begin_s = knots_.front().time_s;
  const double length_s = knots_.back().time_s - begin_s;
  const Eigen::Vector3d turn = log_so3(T_end_corrected.rotation);
  for (Knot& knot : knots_) {
    const double share = (knot.time_s - begin_s) / length_s;
    knot.T_odom_imu = knot.T_odom_imu * Pose{exp_so3(share * turn), share * T_end_corrected.translation};
  }
}

void ScanMotion::finish(const Pose& T_imu_lidar) {
  pieces_.clear();
  if (knots_.empty()) return;
  const Pose T_end_odom = (knots_.back().T_odom_imu * T_imu_lidar).inverse();
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const Pose T_end_knot = T_end_odom * knots_[i].T_odom_imu * T_imu_lidar;
    Piece piece{T_end_knot.rotation.toRotationMatrix().cast<float>(), T_end_knot.translation.cast<float>(),
                Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), static_cast<float>(knots_[i].time_s)};
    const std::size_t next = i + 1;
    if (next < knots_.size() && knots_[next].time_s > knots_[i].time_s) {
      const double dt = knots_[next].time_s - knots_[i].time_s;
      const Pose T_end_next = T_end_odom * knots_[next].T_odom_imu * T_imu_lidar;
      piece.rate_rads = (log_so3(T_end_knot.rotation.conjugate() * T_end_next.rotation) / dt).cast<float>();
      piece.velocity_mps = ((T_end_next.translation - T_end_knot.translation) / dt).cast<float>();
    }
    pieces_.push_back(piece);
  }
}

Eigen::Vector3f ScanMotion::deskew(const Eigen::Vector3f& p_lidar, float time_s) const {
  if (pieces_.empty()) return p_lidar;
  const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), time_s,
                                      [](float t, const Piece& piece) { return t < piece.time_s; });
  const Piece& piece = *(after - 1);
  const float dt = time_s - piece.time_s;
  const Eigen::Vector3f turn = dt * piece.rate_rads;
  const Eigen::Vector3f turned = turn.cross(p_lidar);
  return piece.R_end_knot * (p_lidar + turned + 0.5F * turn.cross(turned)) + piece.t_end_knot + dt * piece.velocity_mps;
}

}  // namespace slamd
