#pragma once
// A GPS receiver of the consumer class: true antenna motion in, NMEA out, with errors that are correlated in time.

#include <GeographicLib/LocalCartesian.hpp>
#include <string>

#include "tools/slam-sim/motion/trajectory.hpp"
#include "tools/slam-sim/sensors/nmea_writer.hpp"
#include "tools/slam-sim/sensors/wire_event.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// World x is east, y north; the world's origin is at the given place. Figures: u-blox NEO-M8 data sheet (2.5 m CEP).
struct GpsModel {
  double rate_hz = 1.0;
  double latitude_deg = 48.2653, longitude_deg = 11.6714, altitude_m = 527.8;  // of the world's origin, ellipsoidal
  double geoid_separation_m = 46.2;
  double utc_start_s = 1780300800.0;  // 2026-06-01 08:00:00 UTC
  double correlated_m = 0.9;          // horizontal standard deviation; vertical is 1.8 times that
  double correlation_s = 60.0;
  double white_m = 0.25;
  double latency_s = 0.120;
  double hdop = 0.9;  // as it claims, whatever its errors
  std::string sentences = "GGA,RMC,GSA,GST";
};

/// A stretch of time with a disturbance: metres of displacement (multipath that the receiver does not notice).
struct GpsDisturbance {
  double from, to;
  double jump_m;
};

class GpsSensor {
 public:
  GpsSensor(const GpsModel& model, const Trajectory& trajectory, const Eigen::Vector3d& p_base_antenna,
            std::uint64_t seed);

  void disturb(const GpsDisturbance& what) { disturbances_.push_back(what); }
  /// One event per sentence of the next fix taken before `until`; empty when there is none.
  std::vector<WireEvent> next(double until);

 private:
  Eigen::Vector3d error_at(double t);
  NmeaFix fix_at(double t);

  GpsModel model_;
  const Trajectory& trajectory_;
  Eigen::Vector3d p_base_antenna_;
  GeographicLib::LocalCartesian local_;
  Rng rng_;
  Eigen::Vector3d correlated_;
  double jump_heading_;
  std::vector<GpsDisturbance> disturbances_;
  std::int64_t count_ = 0;
};

}  // namespace slamd::sim
