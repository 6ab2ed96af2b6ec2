#pragma once
// What can be set of a spinning LiDAR, whichever it is, and what all of them are to a simulation. No sensor lives here.

#include <cstdint>

#include "tools/slam-sim/sensors/beam_caster.hpp"
#include "tools/slam-sim/sensors/sensor_clock.hpp"
#include "tools/slam-sim/sensors/wire_event.hpp"

namespace slamd::sim {

enum class ReturnMode : std::uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };  // as a VLP-16 numbers them

struct LidarModel : BeamModel {
  double rpm = 600.0;
  ReturnMode mode = ReturnMode::kStrongest;
  double laser_bias_m = 0.0;  // standard deviation of a constant range error of each laser
  double clock_skew_ppm = 12.0;
  bool pps_locked = false;  // VLP-16: stamps are UTC past the hour; position packets carry $GPRMC
  double latency_min_s = 0.00003;
  double latency_jitter_s = 0.00035;
};

/// A sensor whose packets are numbered from the start of the drive on.
class PacketSensor {
 public:
  virtual ~PacketSensor() = default;
  /// True time of the packet's first measurement, seconds from the start of the drive.
  virtual double packet_time(std::int64_t index) const = 0;
  /// Thread-safe and a pure function of the index (and the seed).
  virtual WireEvent packet(std::int64_t index) const = 0;
};

}  // namespace slamd::sim
