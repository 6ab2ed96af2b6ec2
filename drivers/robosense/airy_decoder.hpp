#pragma once
// Turns the payloads of one RoboSense Airy into stamped points. It reads no socket and makes no scans: drivers/io brings the bytes,
// estimator/lidar/scan_assembler makes revolutions; its IMU is airy_imu_parser's.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/lidar_stats.hpp"
#include "drivers/io/packet_timeline.hpp"
#include "drivers/robosense/airy_device.hpp"
#include "drivers/robosense/airy_packet.hpp"
#include "estimator/types/lidar_packet.hpp"

namespace slamd {

/// Frame of the points: the sensor's own: origin in the middle of its foot, x = azimuth 0, y = azimuth 270 degrees (left; azimuth
/// runs clockwise seen from above), z up. One thread. No allocation.
class AiryDecoder {
 public:
  explicit AiryDecoder(const LidarDecoderConfig& config);

  /// payload   of one UDP packet of the data port, any bytes
  /// arrival   when the host received it; packets come in this order
  /// Returns the packet's points in order of firing, or null when it was refused (see stats() and last_rejection()), as all are
  ///         until device() is known: a unit's beams lie up to half a degree from where its data sheet says. Valid until the next
  ///         call. Of a dual return two different ones give two points, of which the brighter has return_index 0.
  const LidarPacket* decode(std::span<const std::uint8_t> payload, HostTime arrival);
  /// Of the device port: takes over the directions of the beams. False when it was refused.
  bool inform(std::span<const std::uint8_t> payload);

  const LidarStats& stats() const { return stats_; }
  /// Of the newest refused data packet; kCount when none was. Text by explain().
  LidarRejection last_rejection() const { return last_rejection_; }
  /// What the sensor told about itself; nothing before.
  const std::optional<AiryDevice>& device() const { return device_; }
  const ClockSync& clock() const { return clock_; }

 private:
  struct Beam {
    float cos_elevation, sin_elevation;
    float cos_offset, sin_offset;  // of its azimuth from its column's
    std::int16_t offset_cdeg;
    std::uint8_t ring;
  };
  /// Where a column looks while one group of channels fires.
  struct Aim {
    float cos_azimuth, sin_azimuth;
    std::int32_t azimuth_cdeg;
    std::int32_t time_ns;
  };
  using Aims = std::array<Aim, kAiryChannels / 8>;

  static Aims aim(float azimuth_cdeg, float step_cdeg, Duration column_begin);
  const LidarPacket* refuse(LidarRejection cause);
  void set_beams(const AiryDevice& device);
  void fill_points(const AiryPacket& packet, const HeadRotation& rotation);
  void add_firing(const AiryPacket& packet, std::size_t column, std::size_t channel, const Aim& aim);
  bool in_range(AiryReturn found);
  void add_point(const Beam& beam, const Aim& aim, AiryReturn found, std::uint8_t index);

  LidarDecoderConfig config_;
  std::array<Beam, kAiryChannels> beams_{};
  std::optional<AiryDevice> device_;
  PacketTimeline timeline_;
  ClockSync clock_;
  LidarPacket out_;
  LidarStats stats_;
  LidarRejection last_rejection_ = LidarRejection::kCount;
};

}  // namespace slamd
