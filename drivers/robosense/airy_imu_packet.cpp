#include "drivers/robosense/airy_imu_packet.hpp"

#include <numbers>

#include "drivers/io/byte_reader.hpp"
#include "drivers/robosense/airy_stamp.hpp"

namespace slamd {
namespace {

constexpr std::uint32_t kHeader = 0xAA555A05;
constexpr std::size_t kStampAt = 4;
constexpr std::size_t kRangesAt = 43;  // of accelerometer (2 g times a power of two) and gyroscope (250 deg/s likewise)
constexpr std::uint8_t kMostRange = 3;
constexpr std::int32_t kFullScale = 32'768;
constexpr double kGravity_mps2 = 9.80665;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct Axes {
  Eigen::Vector3d value;
  bool possible = true;
  bool clipped = false;
};

/// Three signed counts, of which 32,768 are the range.
Axes read_axes(ByteReader& reader, double range) {
  Axes axes;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto counts = static_cast<std::int32_t>(reader.u32_be());
    axes.possible = axes.possible && counts >= -kFullScale && counts <= kFullScale;
    axes.clipped = axes.clipped || counts <= 1 - kFullScale || counts >= kFullScale - 1;
    axes.value[i] = static_cast<double>(counts) * range / kFullScale;
  }
  return axes;
}

}  // namespace

Result<AiryImuReading> parse_airy_imu(std::span<const std::uint8_t> payload) {
  if (payload.size() != kAiryImuBytes) return Error{"not 51 bytes long"};
  ByteReader reader{payload};
  if (reader.u32_be() != kHeader) return Error{"does not begin as an IMU packet"};
  const std::optional<DeviceTime> stamp = read_robosense_stamp(payload.subspan<kStampAt, kRobosenseStampBytes>());
  if (!stamp) return Error{"the time stamp is none"};
  ByteReader ranges{payload.subspan(kRangesAt)};
  const std::uint8_t accel_range = ranges.u8();
  const std::uint8_t gyro_range = ranges.u8();
  if (accel_range > kMostRange || gyro_range > kMostRange) return Error{"a range that no such IMU has"};
  reader.skip(kRobosenseStampBytes);
  const Axes accel = read_axes(reader, 2.0 * (1 << accel_range) * kGravity_mps2);
  const Axes gyro = read_axes(reader, 250.0 * (1 << gyro_range) * kRadPerDeg);
  if (!accel.possible || !gyro.possible) return Error{"a value beyond its range"};
  return AiryImuReading{*stamp, gyro.value, accel.value, accel.clipped || gyro.clipped};
}

}  // namespace slamd
