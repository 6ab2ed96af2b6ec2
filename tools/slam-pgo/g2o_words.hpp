#pragma once
// Groups in the words of g2o: names of records, order and number of values. No lines and no files.

#include <span>

#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"

namespace slamd::pgo {

template <class Group>
struct G2oWords;

template <>
struct G2oWords<GroupSe2> {
  static constexpr const char* kVertex = "VERTEX_SE2";
  static constexpr const char* kEdge = "EDGE_SE2";
  static constexpr std::size_t kValues = 3;  // x y yaw

  static bool valid(std::span<const double>) { return true; }
  static PlanarPose element(std::span<const double> v) { return {{v[0], v[1]}, v[2]}; }
  static void values(const PlanarPose& T, std::span<double> v) {
    v[0] = T.translation.x();
    v[1] = T.translation.y();
    v[2] = T.yaw_rad;
  }
};

template <>
struct G2oWords<GroupSe3> {
  static constexpr const char* kVertex = "VERTEX_SE3:QUAT";
  static constexpr const char* kEdge = "EDGE_SE3:QUAT";
  static constexpr std::size_t kValues = 7;  // x y z, quaternion x y z w

  /// A quaternion of norm far from 1 is no rotation that somebody meant.
  static bool valid(std::span<const double> v) {
    const double norm = Eigen::Vector4d{v[3], v[4], v[5], v[6]}.norm();
    return norm > 0.5 && norm < 1.5;
  }
  static Pose element(std::span<const double> v) { return GroupSe3::load(v.data()); }
  static void values(const Pose& T, std::span<double> v) { GroupSe3::store(T, v.data()); }
};

}  // namespace slamd::pgo
