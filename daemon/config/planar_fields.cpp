// The table of keys of planar SLAM: one line says the key, where it lives, its unit, its range and its meaning.

#include "daemon/config/planar_fields.hpp"

namespace slamd {
namespace {

using Fields = std::vector<Field>;

constexpr FieldRange kShare{0, 1};
constexpr FieldRange kSigma{1e-6, 100};
constexpr FieldRange kMetres{1e-3, 1e4};

Fields scan_fields(Scan2dConfig& c) {
  return {
      {"planar.single_ring", &c.single_ring, "", {}, "of a 3D LiDAR one ring alone, the most level one; false = all rings in the band"},
      {"planar.band_low_m", &c.band_low_m, "m", {-100, 100}, "height above base from which on returns of a 3D LiDAR count"},
      {"planar.band_high_m", &c.band_high_m, "m", {-100, 100}, "and up to which"},
      {"planar.min_range_m", &c.min_range_m, "m", {0, 100}, "nearer returns are the vehicle itself"},
      {"planar.max_range_m", &c.max_range_m, "m", {0.1, 1000}, "farther returns are not used"},
      {"planar.spacing_m", &c.spacing_m, "m", {1e-3, 1}, "points of a scan nearer to each other become their mean"},
  };
}

Fields motion_fields(MotionPriorConfig& c) {
  return {
      {"planar.motion.start_mps", &c.start_mps, "m/s", kSigma, "that the vehicle may have at first, without wheels"},
      {"planar.motion.accel_mps2", &c.accel_mps2, "m/s^2", kSigma, "by which the velocity may change, without wheels"},
      {"planar.motion.turn_accel_rads2", &c.turn_accel_rads2, "rad/s^2", kSigma, "likewise the turn rate, without wheels and IMU"},
      {"planar.motion.wheel_slip", &c.wheel_slip, "", kShare, "of the way that the wheels tell"},
      {"planar.motion.wheel_turn_slip", &c.wheel_turn_slip, "", kShare, "of the turn that they tell"},
      {"planar.motion.wheel_turn_rad_m", &c.wheel_turn_rad_m, "rad/m", {0, 1}, "turn that they do not tell"},
      {"planar.motion.gyro_rads", &c.gyro_rads, "rad/s", kSigma, "of the IMU's turn rate, beyond its bias"},
  };
}

Fields matching_fields(PlanarOdometryConfig& c) {
  return {
      {"planar.cell_m", &c.local_map.lines.cell_m, "m", {0.01, 1}, "of the local map; walls are lines through 3 to 5 of them"},
      {"planar.point_sigma_m", &c.local_map.lines.point_sigma_m, "m", kSigma, "noise of a point"},
      {"planar.local_map_m", &c.local_map.length_m, "m", kMetres, "way after which scans are matched against a newer map, at least; and"},
      {"planar.local_map_ranges", &c.local_map.length_ranges, "", {0, 1e4}, "so many mean ranges of a scan"},
      {"planar.search_cell_m", &c.local_map.likelihood.cell_m, "m", {0.01, 1}, "of the correlative search"},
      {"planar.gate_m", &c.matcher.gate_m, "m", kMetres, "points farther from a wall do not count"},
      {"planar.information_scale", &c.matcher.information_scale, "", {1e-4, 1}, "share of residuals that are independent"},
      {"planar.least_inlier_share", &c.least_inlier_share, "", kShare, "of a scan's points on walls; with fewer it is not believed"},
      {"planar.keyframe_distance_m", &c.keyframe_distance_m, "m", kMetres, "travel between two keyframes, at least; and"},
      {"planar.keyframe_ranges", &c.keyframe_ranges, "", {0, 10}, "so many mean ranges of a scan"},
      {"planar.keyframe_angle_rad", &c.keyframe_angle_rad, "rad", {0.01, 3.14}, "turn between two keyframes"},
      {"planar.lost_s", &c.lost_s, "s", {0.1, 3600}, "without a scan that fits: LOST"},
  };
}

Fields map_fields(PlanarMapperConfig& c) {
  return {
      {"planar.resolution_m", &c.occupancy.resolution_m, "m", {0.01, 1}, "of the occupancy grid"},
      {"planar.hit_probability", &c.occupancy.hit_probability, "", {0.01, 0.99}, "that a square in which a ray ended is occupied"},
      {"planar.miss_probability", &c.occupancy.miss_probability, "", {0.01, 0.99}, "that a square through which one went is"},
      {"planar.use_loops", &c.use_loops, "", {}, "search for places seen before and close loops"},
      {"planar.loop_radius_m", &c.loops.radius_m, "m", kMetres, "older places so near are looked at whatever the odometry's drift"},
      {"planar.loop_least_way_m", &c.loops.least_way_m, "m", kMetres, "driven since a place that is looked at, at least"},
      {"planar.loop_least_score", &c.loops.least_score, "", kShare, "of the search: mean likelihood of the points"},
      {"planar.loop_least_inlier_share", &c.loops.least_inlier_share, "", kShare, "of the points on walls, to close a loop"},
      {"planar.byte_budget", &c.byte_budget, "B", {1 << 16, 1e12}, "of the keyframes' points; beyond it the oldest are forgotten"},
      {"planar.max_keyframes", &c.max_keyframes, "", {100, 1e6}, "likewise"},
  };
}

void append(Fields& fields, Fields more) { fields.insert(fields.end(), more.begin(), more.end()); }

}  // namespace

Fields planar_fields(Slam2dConfig& c) {
  Fields fields = scan_fields(c.odometry.scan);
  append(fields, motion_fields(c.odometry.motion));
  append(fields, matching_fields(c.odometry));
  append(fields, map_fields(c.mapper));
  return fields;
}

}  // namespace slamd
