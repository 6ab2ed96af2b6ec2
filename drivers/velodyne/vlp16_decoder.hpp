#pragma once
// Turns the payloads of one VLP-16 into stamped points. It reads no socket and makes no scans: drivers/io brings the
// bytes, estimator/lidar/scan_assembler makes revolutions.

#include <array>
#include <cstdint>
#include <span>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/lidar_stats.hpp"
#include "drivers/io/packet_timeline.hpp"
#include "drivers/velodyne/vlp16_packet.hpp"
#include "drivers/velodyne/vlp16_timing.hpp"
#include "estimator/types/lidar_packet.hpp"

namespace slamd {

/// Frame of the points: x = azimuth 0, y = azimuth 270 degrees (left; azimuth runs clockwise seen from above), z up;
/// origin at the optical centre. The manual's own axes are other ones: x_ours = Y_manual, y_ours = -X_manual. One
/// thread. No allocation after construction.
class Vlp16Decoder {
 public:
  explicit Vlp16Decoder(const LidarDecoderConfig& config);

  /// payload   of one UDP packet of the data port, any bytes
  /// arrival   when the host received it; packets come in this order
  /// Returns the packet's points in order of firing, or null when it was refused (see stats() and last_rejection()).
  /// Valid
  ///         until the next call. In dual-return mode a pair of equal returns gives one point; of two different ones
  ///         the brighter has return_index 0 (at equal brightness that of the odd block, which the sensor calls
  ///         strongest).
  const LidarPacket* decode(std::span<const std::uint8_t> payload, HostTime arrival);

  const LidarStats& stats() const { return stats_; }
  /// Of the newest refused packet; kCount when none was. Text by explain().
  LidarRejection last_rejection() const { return last_rejection_; }
  /// Rotation over the newest accepted packet; 0 before the first.
  double rotation_rpm() const { return rotation_rpm_; }
  const ClockSync& clock() const { return clock_; }

 private:
  /// Direction of every channel of one block.
  struct Beams {
    std::array<float, kVlp16Channels> cos_azimuth;
    std::array<float, kVlp16Channels> sin_azimuth;
    std::array<std::uint16_t, kVlp16Channels> azimuth_cdeg;
  };
  static Beams aim(float azimuth_cdeg, float step_cdeg);

  const LidarPacket* refuse(LidarRejection cause);
  RotationFound rotation_of(const Vlp16Packet& packet) const;
  DeviceTime unwrapped(std::uint32_t stamp_us, HostTime arrival) const;
  void fill_points(const Vlp16Packet& packet, const HeadRotation& rotation);
  void add_single(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found);
  void add_pair(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return even, Vlp16Return odd);
  bool in_range(Vlp16Return found);
  void add_point(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found, std::uint8_t index);

  std::uint16_t min_range_2mm_;
  std::uint16_t max_range_2mm_;
  float share_of_offset_;  // 1 or 0
  RotationLimits rotation_limits_;
  PacketTimeline timeline_;
  ClockSync clock_;
  LidarPacket out_;
  LidarStats stats_;
  LidarRejection last_rejection_ = LidarRejection::kCount;
  double rotation_rpm_ = 0.0;
};

}  // namespace slamd
