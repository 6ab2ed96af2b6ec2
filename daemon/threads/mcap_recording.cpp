#include "daemon/threads/mcap_recording.hpp"

#include <array>
#include <utility>

#include "drivers/ros/compose.hpp"
#include "drivers/ros/schemas.hpp"

namespace slamd {
namespace {

constexpr const char* kMap = "map";
constexpr const char* kOdom = "odom";
constexpr const char* kBase = "base_link";
constexpr const char* kLidar = "lidar";
constexpr const char* kImu = "imu";
constexpr const char* kAntenna = "gps";

Pose pose_of(const std::array<double, 3>& p, const std::array<double, 4>& q) {
  return {Eigen::Quaterniond{q[3], q[0], q[1], q[2]}, {p[0], p[1], p[2]}};
}

}  // namespace

Result<std::unique_ptr<McapRecording>> McapRecording::open(const std::string& path, const std::string& config_yaml,
                                                           const RecordedDrivers& drivers, Duration host_to_utc) {
  Result<McapWriter> file = McapWriter::open(path, "ros2", "slamd");
  if (!file) return Error{file.reason()};
  std::unique_ptr<McapRecording> recording{new McapRecording{std::move(file).value(), drivers, host_to_utc}};
  recording->file_.add_metadata("slamd", {{"version", "1"}, {"host_to_utc_ns", std::to_string(host_to_utc.count())}});
  const std::span yaml{reinterpret_cast<const std::uint8_t*>(config_yaml.data()), config_yaml.size()};
  recording->file_.attach("slamd.yaml", "application/yaml", yaml, 0);
  recording->add_channels();
  if (const Result<void> begun = recording->flush(); !begun) return Error{begun.reason()};
  return recording;
}

McapRecording::McapRecording(McapWriter file, const RecordedDrivers& drivers, Duration host_to_utc)
    : file_{std::move(file)},
      host_to_utc_{host_to_utc},
      vehicle_{drivers.vehicle},
      lidar_port_{drivers.lidar_port},
      lidar_side_port_{drivers.lidar_side_port},
      imu_{drivers.imu_frames},
      gnss_{drivers.nmea},
      assembler_{drivers.scans} {
  if (drivers.lidar_model != LidarModel::kRplidarA2) lidar_.emplace(drivers.lidar_model, drivers.lidar);
}

void McapRecording::add_channels() {
  std::map<std::string, std::uint16_t> schemas;
  const auto add = [&](const std::string& topic, const std::string& type) {
    const auto [known, is_new] = schemas.emplace(type, std::uint16_t{0});
    if (is_new) known->second = file_.add_schema(type, "ros2msg", ros2_schema(type));
    return file_.add_channel(known->second, topic, "cdr");
  };
  channels_.raw_lidar = add("/slamd/raw/lidar", "slamd_msgs/msg/RawRead");
  channels_.raw_imu = add("/slamd/raw/imu", "slamd_msgs/msg/RawRead");
  channels_.raw_gnss = add("/slamd/raw/gps", "slamd_msgs/msg/RawRead");
  channels_.raw_wheel = add("/slamd/raw/wheel", "slamd_msgs/msg/RawRead");
  channels_.scan_share = add("/slamd/scan_share", "slamd_msgs/msg/ScanShare");
  channels_.points = add("/points", "sensor_msgs/msg/PointCloud2");
  channels_.imu = add("/imu", "sensor_msgs/msg/Imu");
  channels_.fix = add("/fix", "sensor_msgs/msg/NavSatFix");
  channels_.odometry = add("/odom", "nav_msgs/msg/Odometry");
  channels_.tf = add("/tf", "tf2_msgs/msg/TFMessage");
  channels_.tf_static = add("/tf_static", "tf2_msgs/msg/TFMessage");
}

void McapRecording::write(std::uint16_t channel, HostTime time, const Bytes& message) {
  file_.write(channel, static_cast<std::uint64_t>(utc_ns(time)), message);
}

void McapRecording::take(RecordedWire wire, const UdpPacket& read) {
  const Bytes raw = compose::raw_read(read);
  switch (wire) {
    case RecordedWire::kLidar:
      write(channels_.raw_lidar, read.arrival, raw);
      take_points(read);
      break;
    case RecordedWire::kImu:
      write(channels_.raw_imu, read.arrival, raw);
      imu_.feed(read.payload, read.arrival, [this](const ImuSample& sample) {
        write(channels_.imu, sample.arrival, compose::imu(utc_ns(sample.time), kImu, sample));
      });
      break;
    case RecordedWire::kGnss:
      write(channels_.raw_gnss, read.arrival, raw);
      gnss_.feed(read.payload, read.arrival, [this](const GnssFix& fix) {
        write(channels_.fix, fix.arrival, compose::nav_sat_fix(utc_ns(fix.time), kAntenna, fix));
      });
      break;
    case RecordedWire::kWheel:
      write(channels_.raw_wheel, read.arrival, raw);
      break;
  }
}

void McapRecording::take_points(const UdpPacket& read) {
  if (lidar_ && read.destination_port == lidar_side_port_) lidar_->side(read.payload);
  if (!lidar_ || read.destination_port != lidar_port_) return;
  const LidarPacket* packet = lidar_->points(read.payload, read.arrival);
  if (packet == nullptr || !assembler_.add(*packet)) return;
  assembler_.take(scan_);
  write_scan();
}

void McapRecording::write_scan() {
  std::vector<compose::CloudPoint> points;
  points.reserve(scan_.points.size());
  for (const LidarPoint& point : scan_.points) points.push_back({point, static_cast<float>(point.time_offset_ns) * 1e-9F});
  write(channels_.points, scan_.arrival, compose::point_cloud(utc_ns(scan_.begin), kLidar, points));
}

void McapRecording::take(const LimitedScan& scan) {
  write(channels_.scan_share, scan.end, compose::scan_share(to_ns(scan.end), scan.share));
}

void McapRecording::take(const PoseSample& sample) {
  const HostTime time = from_ns<HostTime>(sample.host_time_ns);
  const Pose T_odom_base = pose_of(sample.odom_position_m, sample.odom_rotation_xyzw);
  const Pose T_map_odom = pose_of(sample.map_position_m, sample.map_rotation_xyzw) * T_odom_base.inverse();
  compose::Odometry odometry{kOdom, kBase, T_odom_base, sample.covariance};
  odometry.velocity_mps = T_odom_base.rotation.conjugate() * Eigen::Vector3d::Map(sample.velocity_mps.data());
  odometry.angular_velocity_rads = Eigen::Vector3d::Map(sample.angular_velocity_rads.data());
  write(channels_.odometry, time, compose::odometry(utc_ns(time), odometry));
  const std::array transforms{compose::Transform{kMap, kOdom, T_map_odom}, compose::Transform{kOdom, kBase, T_odom_base}};
  write(channels_.tf, time, compose::transforms(utc_ns(time), transforms));
}

void McapRecording::repeat_transforms(HostTime now) {
  const std::array transforms{compose::Transform{kBase, kLidar, vehicle_.T_base_lidar},
                              compose::Transform{kBase, kImu, vehicle_.T_base_imu},
                              compose::Transform{kBase, kAntenna, {Eigen::Quaterniond::Identity(), vehicle_.p_base_antenna}}};
  write(channels_.tf_static, now, compose::transforms(utc_ns(now), transforms));
}

}  // namespace slamd
