#include "tools/slam-sim/output/scenarios.hpp"

#include <numbers>

namespace slamd::sim {
namespace {

void two_laps(DriveSpec& spec) {
  spec.course.kind = CourseKind::kTwoLaps;
}

void hills(DriveSpec& spec) {
  spec.world = WorldKind::kHills;
  spec.course.stop_every_m = 700.0;
}

void rough(DriveSpec& spec) {
  spec.course.length_m = 600.0;
  spec.course.slalom_m = 1.0;
  spec.course.limits.speed_mps = 6.0;
  spec.course.wobble = {0.035, 0.045, 0.040, 0.015, 0.012, 0.10};
}

void moving_start(DriveSpec& spec) {
  spec.course.moving_start = true;
  spec.course.length_m = 600.0;
}

void urban(DriveSpec& spec) {
  spec.world = WorldKind::kUrban;
  spec.crowd = 18;
  spec.gps.correlated_m = 2.0;
}

void corridor(DriveSpec& spec) {
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kLineAndBack;
  spec.with_gps = false;
}

void parking(DriveSpec& spec) {
  spec.world = WorldKind::kParking;
  spec.course.kind = CourseKind::kTwoLaps;
  spec.with_gps = false;
}

void loop(DriveSpec& spec) {
  spec.world = WorldKind::kGrounds;
  spec.course.stop_every_m = 600.0;
  spec.with_wheel = true;
}

/// A TurtleBot3 Burger, two rounds near its highest speed (0.22 m/s, 2.84 rad/s).
void house(DriveSpec& spec) {
  spec.world = WorldKind::kHouse;
  spec.course.kind = CourseKind::kTwoLaps;
  spec.course.stop_every_m = 15.0;
  spec.course.limits = {.speed_mps = 0.215, .acceleration_mps2 = 0.4, .braking_mps2 = 0.4, .lateral_mps2 = 0.1};
  spec.course.wobble = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  spec.lidar_kind = LidarKind::kLaserScan;
  spec.mounting.told = turtlebot3_burger();
  spec.with_gps = false;
  spec.with_wheel = true;
  spec.wheel.rate_hz = 30.0;
  spec.wheel.track_m = 0.160;
  spec.wheel.tick_m = 0.033 * 2 * std::numbers::pi / 4096;
}

}  // namespace

const std::vector<Scenario>& scenarios() {
  static const std::vector<Scenario> kAll{
      {"campus", "900 m round a campus with stops (default)", [](DriveSpec&) {}},
      {"two-laps", "twice round one block of the campus", two_laps},
      {"hills", "3 km round through streets over hills of 24 m", hills},
      {"rough", "600 m of campus swerving over bumps", rough},
      {"crowd", "campus among 45 moving cars and pedestrians", [](DriveSpec& spec) { spec.crowd = 45; }},
      {"moving-start", "600 m of campus, recording begins at full speed", moving_start},
      {"urban", "street canyon with traffic and poor GPS", urban},
      {"corridor", "120 m of featureless corridor and back in reverse, no GPS", corridor},
      {"parking", "two laps in a parking house, no GPS", parking},
      {"loop", "1.8 km once round grounds of 560 m x 363 m, wheel odometry", loop},
      {"house", "TurtleBot3 with a 2D LiDAR and wheel odometry, twice through every room of a house, no GPS", house},
      {"open-field", "hilly field with few trees", [](DriveSpec& spec) { spec.world = WorldKind::kOpenField; }},
  };
  return kAll;
}

const Scenario* find_scenario(const std::string& name) {
  for (const Scenario& scenario : scenarios()) {
    if (name == scenario.name) return &scenario;
  }
  return nullptr;
}

}  // namespace slamd::sim
