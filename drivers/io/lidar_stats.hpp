#pragma once
// What the drivers of spinning LiDARs are told and what they tell: limits, counters, and the causes for which a packet is refused.
// No packet format.

#include <cstdint>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/driver_stats.hpp"
#include "drivers/io/head_rotation.hpp"
#include "drivers/io/packet_timeline.hpp"

namespace slamd {

/// Why a packet gave no points. The first group is found in the packet alone, the second in what came before it.
enum class LidarRejection : std::uint8_t {
  kWrongSize,
  kHeader,          // does not begin as a data packet of the model
  kPositionPacket,  // a position packet on the data port
  kHdl32e,
  kHdl64e,
  kPuckHiRes,
  kVlp32c,
  kVls128,
  kVelarray,
  kUnknownModel,
  kDataType,  // no points in it
  kReturnMode,
  kBlockFlag,
  kAzimuthRange,
  kStampRange,
  kPairMismatch,  // blocks of the same firings name different azimuths
  kChecksum,

  kNoAngles,     // the sensor has not told the directions of its beams yet
  kStopped,      // the azimuth does not advance, or slower than the slowest allowed rotation
  kTooFast,      // or faster than the fastest
  kAzimuthJump,  // uneven steps inside the packet, or no continuation of the packet before
  kOutOfOrder,   // a repeated or late packet
  kStampJump,    // its stamp contradicts the arrival; believed when the next one confirms it
  kCount
};
/// Short English name for reports ("wrong_size").
const char* name(LidarRejection cause);
/// One sentence for the operator's log.
const char* explain(LidarRejection cause);

/// What a turning or a place on the time line that is not believed means for the packet; not of kNone and kAdmitted.
LidarRejection rejection_of(RotationFault fault);
LidarRejection rejection_of(PacketVerdict verdict);

/// ClockSync's defaults, with the smallest delay from the end of a packet's last firing to its arrival.
inline ClockSync::Config lidar_clock() {
  ClockSync::Config config;
  config.min_latency = std::chrono::microseconds{30};
  return config;
}

struct LidarDecoderConfig {
  double min_range_m = 0.5;    // nearer returns are the sensor's own window, its mount or the roof it stands on
  double max_range_m = 130.0;  // the wire formats end at 131.07 m (VLP-16) and 81.9 m (Airy)
  // VLP-16: whether each laser's ray begins at the height that the manual's table 9-1 gives for it (11.2 to -11.2 mm), as in the
  // real sensor, or all at one point, as in recordings of simulators that leave this out.
  bool vertical_offsets = true;
  RotationLimits rotation;
  Duration stamp_tolerance =
      std::chrono::milliseconds{250};  // stamp's advance against arrival's; arrivals stall, stamps do not
  ClockSync::Config clock = lidar_clock();
};

struct LidarStats {
  std::uint64_t received = 0;
  std::uint64_t accepted = 0;
  std::uint64_t lost = 0;         // missing between accepted packets, by their stamps
  std::uint64_t clock_jumps = 0;  // the sensor's clock was set (GPS found, power cycle)
  std::uint64_t points = 0;
  std::uint64_t out_of_range = 0;  // returns dropped by the range limits; no-returns are not counted
  CauseCounters<LidarRejection> rejections;
};

}  // namespace slamd
