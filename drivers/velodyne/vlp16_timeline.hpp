#pragma once
// Puts VLP-16 packets on one unbroken device time line: unwraps the hour, sees lost, repeated and late packets, and
// doubts stamps that contradict the arrival. Does not map to host time (drivers/io/clock_sync does).

#include <cstdint>
#include <optional>

#include "drivers/velodyne/vlp16_packet.hpp"
#include "drivers/velodyne/vlp16_rotation.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// One packet as the time line sees it.
struct Vlp16Arrival {
  DeviceTime begin;  // first firing, unwrapped
  HostTime arrival;
  float azimuth_cdeg = 0.0F;  // of the first firing
  float rate_cdeg_per_ns = 0.0F;
};

struct Vlp16Admission {
  Vlp16Rejection cause;        // kCount when admitted
  DeviceTime begin;            // then: first firing
  std::uint64_t lost_packets;  // and how many are missing before it
  bool jumped;                 // and whether the device's clock was set since the packet before
};

class Vlp16Timeline {
 public:
  /// tolerance   how far the stamp's advance may differ from the arrival's
  explicit Vlp16Timeline(Duration tolerance) : tolerance_{tolerance} {}

  /// Judges the next packet in order of arrival. A stamp that contradicts the arrival is refused once (kStampJump) and
  /// believed when the following packet goes on from it, so that a corrupted stamp costs one packet and a set clock
  /// too. An azimuth that does not continue the packet before is refused (kAzimuthJump) while that packet is recent.
  Vlp16Admission admit(std::uint32_t stamp_us, Duration span, HostTime arrival, const Vlp16Rotation& rotation);

 private:
  bool continues(const Vlp16Arrival& before, const Vlp16Arrival& now) const;

  Duration tolerance_;
  std::optional<Vlp16Arrival> last_;      // admitted
  std::optional<Vlp16Arrival> doubtful_;  // refused for its stamp, waiting for confirmation
};

}  // namespace slamd
