#pragma once
// One revolution of the LiDAR, not yet de-skewed: raw points, and the same surface thinned to segments.

#include <vector>

#include "estimator/types/lidar_packet.hpp"

namespace slamd {

/// The mean of neighbouring returns of one ring on one surface: position and time averaged alike, so that de-skewing
/// the mean equals the mean of the de-skewed points to first order, with the noise of `count` returns averaged.
struct ScanSegment {
  float x, y, z;         // lidar frame at its own time, metres
  float time_s;          // after Scan::begin
  float range_m;
  std::uint16_t count;   // returns averaged
  std::uint8_t ring;
};

struct Scan {
  HostTime begin;    // first firing
  HostTime end;      // end of the last firing; the state is estimated for this instant
  HostTime arrival;  // of its last packet
  bool complete = true;  // false: packets of the revolution were lost
  std::vector<LidarPoint> points;  // time_offset_ns is from `begin` here
  std::vector<ScanSegment> segments;
};

}  // namespace slamd
