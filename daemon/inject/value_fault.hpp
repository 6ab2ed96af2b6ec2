#pragma once
// Failures of a sensor behind a wire that works, played on what its driver gives: stuck, wrong, slow. Stamps stay as they
// are; what needs bytes is in wire_fault.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/inject/fault_switch.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/lidar_packet.hpp"

namespace slamd {

/// Lets one item of four through while it is asked.
class SlowGate {
 public:
  bool lets_through() { return ++asked_ % 4 == 0; }

 private:
  std::uint32_t asked_ = 0;
};

/// One thread; no allocation after construction. verbs must outlive it. Likewise the other two.
class ImuValueFault {
 public:
  explicit ImuValueFault(const FaultSwitch& verbs) : verbs_{verbs} {}

  /// What a working driver gave, made what the failing sensor gives; nullopt: nothing.
  /// Wrong: it turns 0.3 rad/s about z and is pushed with 2 m/s^2 along x, always.
  std::optional<ImuSample> apply(const ImuSample& sample);

 private:
  const FaultSwitch& verbs_;
  SlowGate slow_;
  std::optional<ImuSample> stuck_;
};

class GnssValueFault {
 public:
  explicit GnssValueFault(const FaultSwitch& verbs) : verbs_{verbs} {}

  /// Wrong: 50 m too far east, with the sigma of a good fix.
  std::optional<GnssFix> apply(const GnssFix& fix);

 private:
  const FaultSwitch& verbs_;
  SlowGate slow_;
  std::optional<GnssFix> stuck_;
};

class LidarValueFault {
 public:
  explicit LidarValueFault(const FaultSwitch& verbs);

  /// Stuck: one whole revolution, then that one for ever. Wrong: every range a fifth too long. Null: nothing. What it
  /// returns is valid until the next call, and as long as `packet`.
  const LidarPacket* apply(const LidarPacket& packet);

 private:
  const LidarPacket* stuck(const LidarPacket& packet);
  const LidarPacket* wrong(const LidarPacket& packet);
  void forget_picture();

  const FaultSwitch& verbs_;
  SlowGate slow_;
  std::vector<LidarPacket> picture_;  // one revolution
  std::size_t taken_ = 0;             // packets of it
  std::size_t next_ = 0;              // of them to show
  bool complete_ = false;
  LidarPacket changed_;
};

}  // namespace slamd
