#pragma once
// What one beam of light brings back: ray casting, detection, range noise and brightness, whatever sensor sends it. It knows no
// packet and no pattern of beams.

#include <vector>

#include "tools/slam-sim/motion/traffic.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

/// Everything a sensor may look at. Outlives the sensors.
struct Surroundings {
  const World& world;
  const Traffic& traffic;
  const Trajectory& trajectory;
  VehicleGeometry geometry;
};

/// What a user may set of any LiDAR.
struct BeamModel {
  double range_noise_m = 0.02;    // standard deviation at right angles (data sheet of the VLP-16: +-3 cm typical)
  double divergence_rad = 0.003;  // full angle of a beam
  bool mixed_pixels = false;      // beams split at edges: blended ranges and, in dual mode, both returns
  double reach = 1.0;             // of the receiver, in proportion to its own: dirt on the window, fog
  double clutter = 0.0;           // share of firings that rain or dust returns from within some metres
  double blind_from_deg = 0.0, blind_to_deg = 0.0;  // azimuths without any return, clockwise from the LiDAR's front
};

/// What the data sheet of one says.
struct Optics {
  double nearest_m = 0.4;
  double farthest_m = 130.0;       // a beam is followed so far
  double reach_m = 100.0;          // half of the echoes from 20 % reflectivity at right angles are seen
  double full_m = 100.0;           // beyond it even the brightest fade
  double noise_share = 0.0;        // of the range: triangulation
};

/// One firing.
struct Beam {
  double t;            // true time, seconds from the start of the drive
  double azimuth_rad;  // clockwise from the LiDAR's front, seen from above
  double elevation_rad;
  Eigen::Vector3d origin_lidar;
  double bias_m = 0.0;         // of its laser
};

/// What the receiver makes of it.
struct Echo {
  double range_m = 0.0;  // 0 = nothing came back
  std::uint8_t intensity = 0;
};
struct Echoes {
  Echo last;
  Echo strongest;
};

/// The bodies that move near the sensor, as they were at `time`.
struct Movers {
  std::vector<MovingBody> bodies;
  double time;
};

class BeamCaster {
 public:
  BeamCaster(const BeamModel& model, const Optics& optics, const Surroundings& around)
      : model_{model}, optics_{optics}, around_{around} {}

  /// Thread-safe; a pure function of its arguments and the state of rng.
  Echoes fire(const Beam& beam, const Movers& movers, Rng& rng) const;
  Movers movers_at(double t) const;

 private:
  bool blind(double azimuth_rad) const;
  double detection(double range, double reflectivity, double cosine) const;
  Hit cast(const Ray& ray, double t, const Movers& movers) const;
  Echo sense(const Hit& hit, const Ray& ray, double bias_m, Rng& rng) const;
  Echoes split(const Hit& centre, const Hit& side, const Ray& ray, double bias_m, Rng& rng) const;

  BeamModel model_;
  Optics optics_;
  Surroundings around_;
};

}  // namespace slamd::sim
