#pragma once
// One position fix of a GNSS receiver, WGS-84, with the sigma that the driver believes. Not projected to any plane.

#include <cstdint>

#include "estimator/types/time.hpp"

namespace slamd {

enum class GnssQuality : std::uint8_t { kNone, kAutonomous, kDifferential, kRtkFloat, kRtkFixed, kDeadReckoning, kSimulated };

struct GnssFix {
  HostTime time;     // host time of validity as far as known: arrival minus the configured latency
  HostTime arrival;  // when the host received the sentence by which it was known to be complete
  GnssTime utc;      // receiver's own time; valid when utc_valid
  bool utc_valid = false;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;  // above the WGS-84 ellipsoid (mean sea level + geoid separation)
  bool height_valid = false;
  GnssQuality quality = GnssQuality::kNone;
  std::uint8_t satellites = 0;
  float hdop = 0.0F;
  double sigma_horizontal_m = 0.0;  // 1.0 (strong) .. 5.0 (weak), per axis
  double sigma_vertical_m = 0.0;
  bool velocity_valid = false;
  double speed_mps = 0.0;   // over ground
  double course_deg = 0.0;  // over ground, clockwise from true north
  bool stale = false;       // the receiver repeats an old position: no new information
};

}  // namespace slamd
