#include "tools/slam-sim/output/scenarios.hpp"

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
