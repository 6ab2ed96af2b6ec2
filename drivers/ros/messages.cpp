#include "drivers/ros/messages.hpp"

namespace slamd {
namespace {

constexpr std::size_t kVelodynePayload = 1206;

template <std::size_t N>
std::array<double, N> numbers(MessageReader& from) {
  std::array<double, N> found;
  for (double& number : found) number = from.f64();
  return found;
}

}  // namespace

VelodyneScanMessage VelodyneScanMessage::read(MessageReader& from) {
  VelodyneScanMessage message;
  message.stamp_ns = from.header_stamp_ns();
  const std::size_t count = from.count(kVelodynePayload);
  message.packets.reserve(count);
  for (std::size_t i = 0; i < count && from.ok(); ++i) {
    const std::int64_t stamp_ns = from.time_ns();
    message.packets.push_back({stamp_ns, from.take(kVelodynePayload)});
  }
  return message;
}

PointCloud2Message PointCloud2Message::read(MessageReader& from) {
  PointCloud2Message message;
  message.stamp_ns = from.header_stamp_ns();
  message.height = from.number<std::uint32_t>();
  message.width = from.number<std::uint32_t>();
  const std::size_t fields = from.count(13);
  for (std::size_t i = 0; i < fields && from.ok(); ++i) {
    Field field;
    field.name = from.text();
    field.offset = from.number<std::uint32_t>();
    field.datatype = from.number<std::uint8_t>();
    field.count = from.number<std::uint32_t>();
    message.fields.push_back(field);
  }
  message.is_big_endian = from.number<std::uint8_t>() != 0;
  message.point_step = from.number<std::uint32_t>();
  message.row_step = from.number<std::uint32_t>();
  message.bytes = from.byte_sequence();
  return message;
}

ImuMessage ImuMessage::read(MessageReader& from) {
  ImuMessage message;
  message.stamp_ns = from.header_stamp_ns();
  from.skip_f64(4 + 9);  // orientation and its covariance
  message.angular_velocity = numbers<3>(from);
  from.skip_f64(9);
  message.linear_acceleration = numbers<3>(from);
  return message;
}

NavSatFixMessage NavSatFixMessage::read(MessageReader& from) {
  NavSatFixMessage message;
  message.stamp_ns = from.header_stamp_ns();
  message.status = from.number<std::int8_t>();
  from.number<std::uint16_t>();  // service
  message.latitude_deg = from.f64();
  message.longitude_deg = from.f64();
  message.altitude_m = from.f64();
  message.covariance = numbers<9>(from);
  message.covariance_type = from.number<std::uint8_t>();
  return message;
}

LaserScanMessage LaserScanMessage::read(MessageReader& from) {
  LaserScanMessage message;
  message.stamp_ns = from.header_stamp_ns();
  message.angle_min = from.f32();
  from.f32();  // angle_max follows from the rest
  message.angle_increment = from.f32();
  message.time_increment = from.f32();
  message.scan_time = from.f32();
  message.range_min = from.f32();
  message.range_max = from.f32();
  message.ranges.resize(from.count(sizeof(float)));
  for (float& range : message.ranges) range = from.f32();
  return message;
}

OdometryMessage OdometryMessage::read(MessageReader& from) {
  OdometryMessage message;
  message.stamp_ns = from.header_stamp_ns();
  from.text();  // child_frame_id
  message.position = numbers<3>(from);
  message.rotation_xyzw = numbers<4>(from);
  return message;
}

SentenceMessage SentenceMessage::read(MessageReader& from) {
  SentenceMessage message;
  message.stamp_ns = from.header_stamp_ns();
  message.sentence = from.text();
  return message;
}

RawReadMessage RawReadMessage::read(MessageReader& from) {
  RawReadMessage message;
  const auto source = from.take(message.source.size());
  if (source.size() == message.source.size()) std::copy(source.begin(), source.end(), message.source.begin());
  message.source_port = from.number<std::uint16_t>();
  message.destination_port = from.number<std::uint16_t>();
  message.bytes = from.byte_sequence();
  return message;
}

ScanShareMessage ScanShareMessage::read(MessageReader& from) {
  ScanShareMessage message;
  message.scan_end_host_ns = from.number<std::int64_t>();
  message.share = from.f64();
  return message;
}

std::optional<std::int64_t> read_stamp_ns(std::span<const std::uint8_t> bytes, RosEncoding encoding) {
  MessageReader reader{bytes, encoding};
  const std::int64_t stamp_ns = reader.header_stamp_ns();
  if (!reader.ok()) return std::nullopt;
  return stamp_ns;
}

}  // namespace slamd
