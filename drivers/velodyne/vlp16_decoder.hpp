#pragma once
// Turns the payloads of one VLP-16 into stamped points. It reads no socket and makes no scans: drivers/io brings the
// bytes, estimator/lidar/scan_assembler makes revolutions.

#include <array>
#include <cstdint>
#include <span>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/driver_stats.hpp"
#include "drivers/velodyne/vlp16_packet.hpp"
#include "drivers/velodyne/vlp16_rotation.hpp"
#include "drivers/velodyne/vlp16_timeline.hpp"
#include "drivers/velodyne/vlp16_timing.hpp"
#include "estimator/types/lidar_packet.hpp"

namespace slamd {

/// ClockSync's defaults, with the smallest delay from the end of a packet's last firing to its arrival.
inline ClockSync::Config vlp16_clock() {
  ClockSync::Config config;
  config.min_latency = std::chrono::microseconds{30};
  return config;
}

struct Vlp16Config {
  double min_range_m = 0.5;    // nearer returns are the sensor's own window, its mount or the roof it stands on
  double max_range_m = 130.0;  // the wire format ends at 131.07 m
  // Whether each laser's ray begins at the height that the manual's table 9-1 gives for it (11.2 to -11.2 mm), as in the real
  // sensor, or all at one point, as in recordings of simulators that leave this out.
  bool vertical_offsets = true;
  Vlp16RotationLimits rotation;
  Duration stamp_tolerance =
      std::chrono::milliseconds{250};  // stamp's advance against arrival's; arrivals stall, stamps do not
  ClockSync::Config clock = vlp16_clock();
};

struct Vlp16Stats {
  std::uint64_t received = 0;
  std::uint64_t accepted = 0;
  std::uint64_t lost = 0;         // missing between accepted packets, by their stamps
  std::uint64_t clock_jumps = 0;  // the sensor's clock was set (GPS found, power cycle)
  std::uint64_t points = 0;
  std::uint64_t out_of_range = 0;  // returns dropped by the range limits; no-returns are not counted
  CauseCounters<Vlp16Rejection> rejections;
};

/// Frame of the points: x = azimuth 0, y = azimuth 270 degrees (left; azimuth runs clockwise seen from above), z up;
/// origin at the optical centre. The manual's own axes are other ones: x_ours = Y_manual, y_ours = -X_manual. One
/// thread. No allocation after construction.
class Vlp16Decoder {
 public:
  explicit Vlp16Decoder(const Vlp16Config& config);

  /// payload   of one UDP packet of the data port, any bytes
  /// arrival   when the host received it; packets come in this order
  /// Returns the packet's points in order of firing, or null when it was refused (see stats() and last_rejection()).
  /// Valid
  ///         until the next call. In dual-return mode a pair of equal returns gives one point; of two different ones
  ///         the brighter has return_index 0 (at equal brightness that of the odd block, which the sensor calls
  ///         strongest).
  const LidarPacket* decode(std::span<const std::uint8_t> payload, HostTime arrival);

  const Vlp16Stats& stats() const { return stats_; }
  /// Of the newest refused packet; kCount when none was. Text by explain().
  Vlp16Rejection last_rejection() const { return last_rejection_; }
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

  const LidarPacket* refuse(Vlp16Rejection cause);
  void fill_points(const Vlp16Packet& packet, const Vlp16Rotation& rotation);
  void add_single(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found);
  void add_pair(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return even, Vlp16Return odd);
  bool in_range(Vlp16Return found);
  void add_point(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found, std::uint8_t index);

  std::uint16_t min_range_2mm_;
  std::uint16_t max_range_2mm_;
  float share_of_offset_;  // 1 or 0
  Vlp16RotationLimits rotation_limits_;
  Vlp16Timeline timeline_;
  ClockSync clock_;
  LidarPacket out_;
  Vlp16Stats stats_;
  Vlp16Rejection last_rejection_ = Vlp16Rejection::kCount;
  double rotation_rpm_ = 0.0;
};

}  // namespace slamd
