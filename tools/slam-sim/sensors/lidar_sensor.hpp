#pragma once
// A VLP-16 in a world: data packets by index, every firing cast from the sensor's pose at its own time. Nothing is
// sent. Sources: VLP-16 User Manual 63-9243 Rev. E, chapters 6 and 9, and its data sheet (63-9229).

#include "tools/slam-sim/motion/traffic.hpp"
#include "tools/slam-sim/sensors/sensor_clock.hpp"
#include "tools/slam-sim/sensors/wire_event.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

enum class ReturnMode : std::uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };

struct LidarModel {
  double rpm = 600.0;
  ReturnMode mode = ReturnMode::kStrongest;
  double range_noise_m = 0.02;    // standard deviation at right angles (data sheet: +-3 cm typical)
  double laser_bias_m = 0.0;      // standard deviation of a constant range error of each laser
  double divergence_rad = 0.003;  // full angle of a beam
  bool mixed_pixels = false;      // beams split at edges: blended ranges and, in dual mode, both returns
  double reach = 1.0;         // of the receiver, in proportion to its own: dirt on the window, fog
  double clutter = 0.0;       // share of firings that rain or dust returns from within some metres
  double blind_from_deg = 0.0, blind_to_deg = 0.0;  // azimuths without any return, clockwise from the LiDAR's front
  double clock_skew_ppm = 12.0;
  bool pps_locked = false;  // stamps are UTC past the hour; position packets carry $GPRMC
  double latency_min_s = 0.00003;
  double latency_jitter_s = 0.00035;
};

/// Everything a sensor may look at. Outlives the sensors.
struct Surroundings {
  const World& world;
  const Traffic& traffic;
  const Trajectory& trajectory;
  VehicleGeometry geometry;
};

class LidarSensor {
 public:
  LidarSensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed);

  /// True time of the packet's first firing, seconds from the start of the drive.
  double packet_time(std::int64_t index) const;
  /// Thread-safe and a pure function of the index (and the seed).
  WireEvent packet(std::int64_t index) const;
  double packet_period() const;

 private:
  struct Return {
    std::uint16_t distance_2mm = 0;
    std::uint8_t intensity = 0;
  };
  struct Echoes {
    Return last;
    Return strongest;
  };
  struct Aim {  // one firing
    double t;
    double azimuth_rad;
    int laser;
  };
  bool dual() const { return model_.mode == ReturnMode::kDual; }
  bool blind(double azimuth_rad) const;
  Hit cast(const Ray& ray, double t, const std::vector<MovingBody>& movers, double movers_time) const;
  Return sense(const Hit& hit, const Ray& ray, int laser, Rng& rng) const;
  Echoes fire(const Aim& aim, const std::vector<MovingBody>& movers, double movers_time, Rng& rng) const;
  Echoes split(const Hit& centre, const Hit& side, const Ray& ray, int laser, Rng& rng) const;

  LidarModel model_;
  Surroundings around_;
  SensorClock clock_;
  std::uint64_t seed_;
  std::array<double, 16> laser_bias_m_{};
};

}  // namespace slamd::sim
