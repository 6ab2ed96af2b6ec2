#pragma once
// Bytes that reach the host at a moment: what every simulated sensor makes. No sockets and no files.

#include <cstdint>
#include <vector>

namespace slamd::sim {

/// kPosition: the second port of a spinning LiDAR (VLP-16 position packets, Airy device packets); kLidarImu: of an IMU built into it.
enum class Channel : std::uint8_t { kLidar, kPosition, kLidarImu, kImu, kGps, kWheel };
inline constexpr int kChannels = 6;

/// Times are nanoseconds from the start of the drive.
struct WireEvent {
  Channel channel = Channel::kLidar;
  std::int64_t taken_ns = 0;    // when the sensor measured (lidar: first firing of the packet)
  std::int64_t arrival_ns = 0;  // when the host has received all bytes
  std::vector<std::uint8_t> bytes;
};

}  // namespace slamd::sim
