#pragma once
// A whole drive: world, motion, sensors and faults from one specification, handed out as wire events in order of
// arrival. It knows no clock and no output: the same specification gives the same bytes, live or to a folder.

#include <memory>
#include <span>

#include "tools/slam-sim/sensors/fault.hpp"
#include "tools/slam-sim/sensors/gps_sensor.hpp"
#include "tools/slam-sim/sensors/imu_sensor.hpp"
#include "tools/slam-sim/sensors/lidar_model.hpp"
#include "tools/slam-sim/sensors/mounting.hpp"
#include "tools/slam-sim/sensors/planar_lidar_sensor.hpp"
#include "tools/slam-sim/sensors/rplidar_sensor.hpp"
#include "tools/slam-sim/sensors/wheel_sensor.hpp"

namespace slamd::sim {

enum class CourseKind { kLoop, kTwoLaps, kFigureEight, kLineAndBack, kStandstill };

struct CourseSpec {
  CourseKind kind = CourseKind::kLoop;
  int laps = 1;            // so many times the course, where it is closed
  bool moving_start = false;
  SpeedLimits limits{.speed_mps = 0.0};  // 0 = the world's limit
  double rest_s = 2.0;     // at the start
  double length_m = 0.0;   // 0 = the whole course; else it ends there
  double slalom_m = 0.0;
  double stop_every_m = 300.0;
  Wobble wobble;
};

/// Named as in vehicle.yaml.
enum class LidarKind { kVlp16, kAiry, kRplidarA2, kLaserScan };
const char* name(LidarKind kind);

/// UDP ports that a spinning LiDAR sends to as delivered; 0 = it has none.
struct LidarPorts {
  std::uint16_t points, side, imu;
};
LidarPorts ports_of(LidarKind kind);

struct DriveSpec {
  WorldKind world = WorldKind::kCampus;
  CourseSpec course;
  std::uint64_t seed = 1;
  int crowd = 0;
  double max_duration_s = 0.0;  // 0 = until the course ends
  int threads = 0;              // 0 = one per core; without influence on the bytes
  bool with_lidar = true, with_imu = true, with_gps = true, with_wheel = false;
  LidarKind lidar_kind = LidarKind::kVlp16;
  LidarModel lidar;
  RplidarFirmware rplidar = RplidarFirmware::kBoost;
  PlanarLidarModel planar_lidar;
  ImuModel imu;
  GpsModel gps;
  WheelModel wheel;
  std::vector<Fault> faults;
  Mounting mounting;
};

class Simulation {
 public:
  explicit Simulation(const DriveSpec& spec);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Events that arrive in the next half second of the drive, in order of arrival. One thread calls.
  std::vector<WireEvent> next_slice();
  bool done() const;
  /// Drive time up to which events have been handed out, seconds.
  double time() const;
  double duration() const;
  const Trajectory& trajectory() const;
  const World& world() const;
  /// As the vehicle's configuration says it.
  const VehicleGeometry& vehicle() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace slamd::sim
