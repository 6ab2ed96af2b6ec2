#include "drivers/robosense/airy_device.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr std::uint64_t kHeader = 0xA5FF005A11115555;
constexpr std::uint16_t kTail = 0x0FF0;
constexpr std::size_t kSerialAt = 292;
constexpr std::size_t kReturnModeAt = 300;
constexpr std::size_t kElevationsAt = 468;
constexpr std::size_t kAzimuthOffsetsAt = kElevationsAt + 3 * kAiryChannels;
constexpr std::size_t kImuPoseAt = 1092;  // quaternion x y z w, translation x y z, as floats
constexpr std::size_t kTailAt = kAiryDeviceBytes - 2;
constexpr std::int16_t kMostCdeg = 9'000;
constexpr double kMostLever_m = 0.5;  // the whole sensor is smaller

using Angles = std::array<std::int16_t, kAiryChannels>;

/// A sign byte (0 = positive, FF = not calibrated) and hundredths of a degree for each channel.
bool read_angles(ByteReader reader, Angles& angles_cdeg) {
  for (std::int16_t& angle_cdeg : angles_cdeg) {
    const std::uint8_t sign = reader.u8();
    const std::uint16_t size_cdeg = reader.u16_be();
    if (sign == 0xFF || size_cdeg > kMostCdeg) return false;
    angle_cdeg = static_cast<std::int16_t>(sign == 0 ? size_cdeg : -static_cast<int>(size_cdeg));
  }
  return true;
}

double read_float(ByteReader& reader) { return static_cast<double>(std::bit_cast<float>(reader.u32_be())); }

void read_imu_pose(ByteReader reader, AiryDevice& device) {
  std::array<double, 7> v{};
  for (double& value : v) value = read_float(reader);
  const Eigen::Quaterniond rotation{v[3], v[0], v[1], v[2]};
  const Eigen::Vector3d lever{v[4], v[5], v[6]};
  device.has_imu_pose = std::abs(rotation.norm() - 1.0) < 1e-3 && lever.norm() < kMostLever_m;  // NaN fails
  if (!device.has_imu_pose) return;
  device.R_lidar_imu = rotation.normalized();
  device.t_lidar_imu = lever;
}

}  // namespace

Result<AiryDevice> parse_airy_device(std::span<const std::uint8_t> payload) {
  if (payload.size() != kAiryDeviceBytes) return Error{"not 1248 bytes long"};
  ByteReader reader{payload};
  if (reader.u64_be() != kHeader) return Error{"does not begin as a device packet"};
  if (ByteReader{payload.subspan(kTailAt)}.u16_be() != kTail) return Error{"does not end as a device packet"};
  AiryDevice device;
  device.rpm = reader.u16_be();
  device.return_mode = payload[kReturnModeAt];
  std::copy_n(payload.begin() + kSerialAt, device.serial.size(), device.serial.begin());
  const bool calibrated = read_angles(ByteReader{payload.subspan(kElevationsAt)}, device.elevation_cdeg) &&
                          read_angles(ByteReader{payload.subspan(kAzimuthOffsetsAt)}, device.azimuth_offset_cdeg);
  if (!calibrated) return Error{"the angles of its beams are missing or beyond 90 degrees"};
  read_imu_pose(ByteReader{payload.subspan(kImuPoseAt)}, device);
  return device;
}

}  // namespace slamd
