#pragma once
// What a drive's GPS receiver said, as a reference for trajectories: a track that is itself a metre wrong. No alignment.

#include <filesystem>

#include "tools/slam-eval/metrics.hpp"
#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {

struct GpsTrack {
  Trajectory antenna;               // east, north, up of the first fix, metres; host time of validity; no attitude
  Eigen::Vector3d p_base_antenna = Eigen::Vector3d::Zero();
};

/// drive  folder with gps.csv and, for the antenna's place, vehicle.yaml. Empty without a fix. Throws InputError for a
/// vehicle.yaml that cannot be read.
GpsTrack load_gps_track(const std::filesystem::path& drive);

/// Errors of the antenna's horizontal place, SE(3)-aligned, at every fix that the estimate (base) covers; none with fewer than three.
Statistics ape_to_gps(const GpsTrack& track, const Trajectory& estimate);

}  // namespace slamd::eval
