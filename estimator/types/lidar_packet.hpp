#pragma once
// The decoded points of one LiDAR data packet. Not a revolution: estimator/lidar/scan_assembler makes scans of packets.

#include <array>
#include <cstdint>
#include <type_traits>

#include "estimator/types/time.hpp"

namespace slamd {

struct LidarPoint {
  float x, y, z;                // lidar frame at its own firing, metres
  std::int32_t time_offset_ns;  // own firing time minus LidarPacket::time
  std::uint16_t azimuth_cdeg;   // 0..35999, clockwise seen from above, as the sensor counts
  std::uint8_t ring;            // 0 = lowest elevation
  std::uint8_t intensity;       // calibrated reflectivity, 0..255
  std::uint8_t return_index;    // 0 = the return of a single-return sensor or the strongest; 1 = the other one of a pair
};

struct LidarPacket {
  static constexpr std::size_t kMaxPoints = 384;

  HostTime time;                    // first firing of the packet
  HostTime arrival;                 // when the host received it; orders the events
  Duration span{};                  // first firing to end of the last one
  std::uint16_t azimuth_begin_cdeg = 0;  // of the first and of the last firing, also when nothing returned
  std::uint16_t azimuth_end_cdeg = 0;
  std::uint16_t point_count = 0;
  bool clock_unsure = false;        // the device's clock jumped and is not locked again
  std::array<LidarPoint, kMaxPoints> points;  // the first point_count hold returns within the sensor's range
};
static_assert(std::is_trivially_copyable_v<LidarPoint>);

}  // namespace slamd
