#pragma once
// Puts the packets of a spinning LiDAR on one unbroken device time line: sees lost, repeated and late packets, and doubts
// stamps that contradict the arrival. Does not unwrap stamps (the driver) or map to host time (clock_sync).

#include <cstdint>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

/// One packet as the time line sees it; of what does not turn both azimuth figures stay zero.
struct PacketMoment {
  DeviceTime begin;  // first firing
  HostTime arrival;
  float azimuth_cdeg = 0.0F;  // of the first firing
  float rate_cdeg_per_ns = 0.0F;
};

enum class PacketVerdict : std::uint8_t { kAdmitted, kOutOfOrder, kAzimuthJump, kStampJump };

struct PacketAdmission {
  PacketVerdict verdict = PacketVerdict::kAdmitted;
  std::uint64_t lost_packets = 0;  // missing before it
  bool jumped = false;             // the device's clock was set since the packet before
};

class PacketTimeline {
 public:
  /// tolerance   how far the stamp's advance may differ from the arrival's
  explicit PacketTimeline(Duration tolerance) : tolerance_{tolerance} {}

  /// Where the device's clock should be for a packet that arrives now; nothing before the first.
  std::optional<DeviceTime> expected(HostTime arrival) const;

  /// Judges the next packet in order of arrival; span is the time from one packet to the next. A stamp that contradicts the
  /// arrival is refused once (kStampJump) and believed when the following packet goes on from it, so that a corrupted stamp
  /// costs one packet and a set clock too. An azimuth that does not continue the packet before is refused (kAzimuthJump)
  /// while that packet is recent.
  PacketAdmission admit(const PacketMoment& now, Duration span);

 private:
  bool continues(const PacketMoment& before, const PacketMoment& now) const;

  Duration tolerance_;
  std::optional<PacketMoment> last_;      // admitted
  std::optional<PacketMoment> doubtful_;  // refused for its stamp, waiting for confirmation
};

}  // namespace slamd
