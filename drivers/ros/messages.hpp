#pragma once
// The ROS messages that carry what slamd's sensors measure, with the fields that slamd needs of them. Values are as they were sent:
// units are ROS's, nothing is judged.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/ros/message_reader.hpp"

namespace slamd {

/// Each has kType, its name without ROS 2's "/msg/", and read(), which leaves the reader's ok() false where the bytes are none.
/// What a message borrows lives as long as the bytes.
struct VelodyneScanMessage {
  static constexpr std::string_view kType = "velodyne_msgs/VelodyneScan";
  struct Packet {
    std::int64_t stamp_ns;
    std::span<const std::uint8_t> payload;  // 1,206 bytes
  };
  std::int64_t stamp_ns = 0;
  std::vector<Packet> packets;
  static VelodyneScanMessage read(MessageReader& from);
};

struct PointCloud2Message {
  static constexpr std::string_view kType = "sensor_msgs/PointCloud2";
  struct Field {
    std::string_view name;
    std::uint32_t offset = 0;
    std::uint8_t datatype = 0;  // 1..8: int8, uint8, int16, uint16, int32, uint32, float32, float64
    std::uint32_t count = 0;
  };
  std::int64_t stamp_ns = 0;
  std::uint32_t height = 0, width = 0;
  std::vector<Field> fields;
  bool is_big_endian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::span<const std::uint8_t> bytes;
  static PointCloud2Message read(MessageReader& from);
};

struct ImuMessage {
  static constexpr std::string_view kType = "sensor_msgs/Imu";
  std::int64_t stamp_ns = 0;
  std::array<double, 3> angular_velocity{}, linear_acceleration{};
  static ImuMessage read(MessageReader& from);
};

struct NavSatFixMessage {
  static constexpr std::string_view kType = "sensor_msgs/NavSatFix";
  std::int64_t stamp_ns = 0;
  std::int8_t status = -1;  // -1 none, 0 fix, 1 satellite-based, 2 ground-based augmentation
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  std::array<double, 9> covariance{};  // east, north, up, row-major
  std::uint8_t covariance_type = 0;    // 0: unknown
  static NavSatFixMessage read(MessageReader& from);
};

struct LaserScanMessage {
  static constexpr std::string_view kType = "sensor_msgs/LaserScan";
  std::int64_t stamp_ns = 0;  // of the first beam
  float angle_min = 0.0F, angle_increment = 0.0F, time_increment = 0.0F, scan_time = 0.0F, range_min = 0.0F, range_max = 0.0F;
  std::vector<float> ranges;
  static LaserScanMessage read(MessageReader& from);
};

struct OdometryMessage {
  static constexpr std::string_view kType = "nav_msgs/Odometry";
  std::int64_t stamp_ns = 0;
  std::array<double, 3> position{};
  std::array<double, 4> rotation_xyzw{};
  static OdometryMessage read(MessageReader& from);
};

struct SentenceMessage {
  static constexpr std::string_view kType = "nmea_msgs/Sentence";
  std::int64_t stamp_ns = 0;
  std::string_view sentence;
  static SentenceMessage read(MessageReader& from);
};

/// Of slamd's own recordings: a read of a device as the host got it.
struct RawReadMessage {
  static constexpr std::string_view kType = "slamd_msgs/RawRead";
  std::array<std::uint8_t, 16> source{};
  std::uint16_t source_port = 0, destination_port = 0;
  std::span<const std::uint8_t> bytes;
  static RawReadMessage read(MessageReader& from);
};

/// Likewise: a scan for which the estimator had too little time.
struct ScanShareMessage {
  static constexpr std::string_view kType = "slamd_msgs/ScanShare";
  std::int64_t scan_end_host_ns = 0;
  double share = 1.0;
  static ScanShareMessage read(MessageReader& from);
};

/// The message in `bytes`, or nothing when they are none. Bytes behind its last field are left alone.
template <class Message>
std::optional<Message> read_message(std::span<const std::uint8_t> bytes, RosEncoding encoding) {
  MessageReader reader{bytes, encoding};
  Message message = Message::read(reader);
  if (!reader.ok()) return std::nullopt;
  return message;
}

/// Stamp of the header with which each of these messages begins.
std::optional<std::int64_t> read_stamp_ns(std::span<const std::uint8_t> bytes, RosEncoding encoding);

}  // namespace slamd
