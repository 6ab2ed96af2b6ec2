#pragma once
// What slamd measures and estimates as serialised ROS 2 messages. Stamps are UTC in nanoseconds: who calls knows how host time stands to
// it.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/io/udp_packet.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/lidar_packet.hpp"
#include "estimator/types/pose.hpp"

namespace slamd::compose {

using Message = std::vector<std::uint8_t>;

Message imu(std::int64_t stamp_ns, std::string_view frame, const ImuSample& sample);
Message nav_sat_fix(std::int64_t stamp_ns, std::string_view frame, const GnssFix& fix);

/// A point of a cloud: its place in the LiDAR's frame and its firing after the cloud's stamp.
struct CloudPoint {
  LidarPoint point;
  float time_s;
};
/// Fields x, y, z, intensity (float32), ring (uint16), time (float32, seconds after the stamp); 22 bytes a point.
Message point_cloud(std::int64_t stamp_ns, std::string_view frame, std::span<const CloudPoint> points);

struct Transform {
  std::string_view parent, child;
  Pose T_parent_child;
};
Message transforms(std::int64_t stamp_ns, std::span<const Transform> transforms);

struct Odometry {
  std::string_view frame, child_frame;
  Pose T_frame_child;
  std::array<double, 36> pose_covariance{};  // position in frame, then attitude
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();          // of child, in child
  Eigen::Vector3d angular_velocity_rads = Eigen::Vector3d::Zero();  // likewise
};
Message odometry(std::int64_t stamp_ns, const Odometry& odometry);

/// slamd_msgs/msg/RawRead: a read of a device as the host got it.
Message raw_read(const UdpPacket& read);
/// slamd_msgs/msg/ScanShare.
Message scan_share(std::int64_t scan_end_host_ns, double share);

}  // namespace slamd::compose
