#include "drivers/ros/compose.hpp"

#include <cmath>

#include "drivers/ros/message_writer.hpp"

namespace slamd::compose {
namespace {

constexpr std::uint32_t kPointBytes = 22;
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kUint16 = 4;

void put(MessageWriter& writer, const Eigen::Vector3d& v) { writer.put(v.x()).put(v.y()).put(v.z()); }
void put(MessageWriter& writer, const Eigen::Quaterniond& q) { writer.put(q.x()).put(q.y()).put(q.z()).put(q.w()); }

/// Row-major 3x3 with these on its diagonal.
void put_diagonal(MessageWriter& writer, const std::array<double, 3>& d) {
  for (std::size_t i = 0; i < 9; ++i) writer.put(i % 4 == 0 ? d[i / 4] : 0.0);
}

std::int8_t status(GnssQuality quality) {
  switch (quality) {
    case GnssQuality::kNone: return -1;
    case GnssQuality::kDifferential: return 1;
    case GnssQuality::kRtkFloat:
    case GnssQuality::kRtkFixed: return 2;
    default: return 0;
  }
}

}  // namespace

Message imu(std::int64_t stamp_ns, std::string_view frame, const ImuSample& sample) {
  MessageWriter writer;
  writer.header(stamp_ns, frame);
  put(writer, Eigen::Quaterniond::Identity());
  put_diagonal(writer, {-1.0, 0.0, 0.0});  // no orientation is measured
  put(writer, sample.gyro_rads);
  put_diagonal(writer, {});
  put(writer, sample.accel_mps2);
  put_diagonal(writer, {});
  return writer.bytes();
}

Message nav_sat_fix(std::int64_t stamp_ns, std::string_view frame, const GnssFix& fix) {
  const double horizontal = fix.sigma_horizontal_m * fix.sigma_horizontal_m;
  MessageWriter writer;
  writer.header(stamp_ns, frame).put(status(fix.quality)).put(std::uint16_t{1});
  writer.put(fix.latitude_deg).put(fix.longitude_deg).put(fix.height_valid ? fix.height_m : std::nan(""));
  put_diagonal(writer, {horizontal, horizontal, fix.sigma_vertical_m * fix.sigma_vertical_m});
  writer.put(std::uint8_t{2});  // the diagonal is known
  return writer.bytes();
}

Message point_cloud(std::int64_t stamp_ns, std::string_view frame, std::span<const CloudPoint> points) {
  MessageWriter writer;
  const auto count = static_cast<std::uint32_t>(points.size());
  writer.header(stamp_ns, frame).put(std::uint32_t{1}).put(count).count(6);
  const auto field = [&writer](std::string_view name, std::uint32_t offset, std::uint8_t type) {
    writer.text(name).put(offset).put(type).put(std::uint32_t{1});
  };
  field("x", 0, kFloat32);
  field("y", 4, kFloat32);
  field("z", 8, kFloat32);
  field("intensity", 12, kFloat32);
  field("ring", 16, kUint16);
  field("time", 18, kFloat32);
  writer.put(std::uint8_t{0}).put(kPointBytes).put(count * kPointBytes).count(points.size() * kPointBytes);
  MessageWriter packed{RosEncoding::kRos1};
  for (const auto& [point, time_s] : points) {
    packed.put(point.x).put(point.y).put(point.z).put(static_cast<float>(point.intensity)).put(std::uint16_t{point.ring}).put(time_s);
  }
  writer.raw(packed.bytes()).put(std::uint8_t{1});
  return writer.bytes();
}

Message transforms(std::int64_t stamp_ns, std::span<const Transform> transforms) {
  MessageWriter writer;
  writer.count(transforms.size());
  for (const Transform& transform : transforms) {
    writer.header(stamp_ns, transform.parent).text(transform.child);
    put(writer, transform.T_parent_child.translation);
    put(writer, transform.T_parent_child.rotation);
  }
  return writer.bytes();
}

Message odometry(std::int64_t stamp_ns, const Odometry& odometry) {
  MessageWriter writer;
  writer.header(stamp_ns, odometry.frame).text(odometry.child_frame);
  put(writer, odometry.T_frame_child.translation);
  put(writer, odometry.T_frame_child.rotation);
  writer.put_all(odometry.pose_covariance);
  put(writer, odometry.velocity_mps);
  put(writer, odometry.angular_velocity_rads);
  writer.put_all(std::array<double, 36>{});
  return writer.bytes();
}

Message raw_read(const UdpPacket& read) {
  MessageWriter writer;
  writer.raw(read.source.bytes).put(read.source_port).put(read.destination_port).byte_sequence(read.payload);
  return writer.bytes();
}

Message scan_share(std::int64_t scan_end_host_ns, double share) {
  return MessageWriter{}.put(scan_end_host_ns).put(share).bytes();
}

}  // namespace slamd::compose
