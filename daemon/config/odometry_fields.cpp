// The estimator's table of keys: one line says the key, where it lives, its unit, its range and its meaning.

#include "daemon/config/odometry_fields.hpp"

namespace slamd {
namespace {

using Fields = std::vector<Field>;

constexpr FieldRange kCount{1, 1e6};
constexpr FieldRange kShare{0, 1};
constexpr FieldRange kSigma{1e-6, 100};
constexpr FieldRange kSeconds{1e-3, 60};
constexpr FieldRange kMetres{1e-3, 1e4};

void append(Fields& fields, Fields more) {
  fields.insert(fields.end(), more.begin(), more.end());
}

Fields facade_fields(OdometryConfig& c) {
  return {
      {"odometry.imu_deadline_s", &c.scans.imu_deadline_s, "s", {0, 1}, "a scan waits so long for the IMU to cover it"},
      {"odometry.imu_timeout_s", &c.imu.timeout_s, "s", kSeconds, "no usable sample for so long: DEGRADED no_imu"},
      {"odometry.lidar_timeout_s", &c.lidar_timeout_s, "s", kSeconds, "no scan for so long: DEGRADED no_lidar"},
      {"odometry.max_test_ratio", &c.status.max_test_ratio, "", {0.1, 1000},
       "mean squared normalised residual beyond which scan and map disagree"},
      {"odometry.usable_sigma_m", &c.status.usable_sigma_m, "m", kMetres,
       "position sigma beyond which the pose is DEGRADED"},
      {"odometry.lost_sigma_m", &c.status.lost_sigma_m, "m", kMetres, "position sigma beyond which the pose is LOST"},
      {"odometry.max_unfused_scans", &c.fusion.max_unfused_scans, "", kCount,
       "in a row; then a new local map is begun"},
      {"odometry.keyframe_distance_m", &c.keyframes.distance_m, "m", kMetres, "travel between two keyframes"},
      {"odometry.keyframe_angle_rad", &c.keyframes.angle_rad, "rad", {0.01, 3.14}, "rotation between two keyframes"},
  };
}

Fields drift_fields(MapDriftConfig& c) {
  return {
      {"odometry.drift.renewal_m", &c.renewal_m, "m", {1, 10000},
       "travel in which the local map takes on the pose's own uncertainty"},
      {"odometry.drift.position_m_rtm", &c.position_m_rtm, "m/rtm", {0, 1}, "random walk of the local map besides"},
      {"odometry.drift.attitude_rad_rtm", &c.attitude_rad_rtm, "rad/rtm", {0, 1}, "likewise"},
      {"odometry.drift.first_tilt_rad", &c.first_tilt_rad, "rad", {0, 1}, "of a map just begun"},
      {"odometry.drift.first_heading_rad", &c.first_heading_rad, "rad", {0, 1}, "likewise"},
      {"odometry.drift.first_position_m", &c.first_position_m, "m", {0, 10}, "likewise"},
      {"odometry.drift.held_position_m", &c.held_position_m, "m", {1e-6, 1},
       "noise of a keyframe in a map that holds it: up to this it does not add up"},
      {"odometry.drift.held_attitude_rad", &c.held_attitude_rad, "rad", {1e-7, 1}, "likewise"},
      {"odometry.drift.moving_velocity_share", &c.moving_velocity_share, "", {0, 1},
       "scans alone tell a velocity to so much of itself"},
      {"odometry.drift.moving_skew_s", &c.moving_skew_s, "s", {0, 10}, "a map begun while moving takes it in for so long"},
      {"odometry.drift.moving_lever_m", &c.moving_lever_m, "m", {0.1, 1000}, "so far displaced it is turned by a radian"},
  };
}

Fields moving_start_fields(VelocitySearchConfig& c) {
  return {
      {"odometry.moving_start.scans", &c.scans, "", kCount, "fused one against the other until a velocity is known"},
      {"odometry.moving_start.found_sigma_mps", &c.found_sigma_mps, "m/s", kSigma, "of velocity by each of those scans"},
      {"odometry.moving_start.round_scans", &c.round_scans, "", kCount,
       "fused after those on one map; rounds follow each other until all has settled"},
      {"odometry.moving_start.round_sigma_mps", &c.round_sigma_mps, "m/s", kSigma, "of velocity as a round begins"},
      {"odometry.moving_start.round_gyro_bias_rads", &c.round_gyro_bias_rads, "rad/s", kSigma, "of gyro bias, likewise"},
      {"odometry.moving_start.least_rounds", &c.least_rounds, "", kCount, "before anything is taken for settled"},
      {"odometry.moving_start.settled_mps", &c.settled_mps, "m/s", kSigma,
       "a round that corrected velocity by less is the last one"},
      {"odometry.moving_start.settled_test_ratio", &c.settled_test_ratio, "", kSigma,
       "if its scans agreed with its map so well"},
      {"odometry.moving_start.limit_s", &c.limit_s, "s", kSeconds, "not settled in this time: LOST until it is"},
      {"odometry.moving_start.max_unfused", &c.max_unfused, "", kCount,
       "scans in a row; then the search goes on from the newest one"},
  };
}

Fields sanity_fields(ImuSanityConfig& c) {
  return {
      {"odometry.imu_sanity.frozen_s", &c.frozen_s, "s", kSeconds, "all six values the same for so long: stuck"},
      {"odometry.imu_sanity.frozen_part_s", &c.frozen_part_s, "s", kSeconds,
       "likewise the three of gyro or accelerometer alone"},
      {"odometry.imu_sanity.least_force_mps2", &c.least_force_mps2, "m/s^2", {0, 9},
       "a sample that says less than a vehicle feels is not used"},
      {"odometry.imu_sanity.most_force_mps2", &c.most_force_mps2, "m/s^2", {11, 10'000}, "nor one that says more"},
      {"odometry.imu_sanity.most_turn_rads", &c.most_turn_rads, "rad/s", {0.1, 1000}, "or that it turns faster"},
      {"odometry.imu_sanity.implausible_s", &c.implausible_s, "s", kSeconds, "an IMU that says so for so long is broken"},
      {"odometry.imu_sanity.sane_again_s", &c.sane_again_s, "s", kSeconds,
       "of good samples until a broken IMU is believed again"},
  };
}

Fields doubt_fields(ImuDoubtConfig& c) {
  return {
      {"odometry.imu_doubt.most_correction_sigmas", &c.most_correction_sigmas, "", {0.1, 1e6},
       "a scan that moves the IMU's prediction by more is fused without the IMU"},
      {"odometry.imu_doubt.gyro_bias_rads", &c.gyro_bias_rads, "rad/s", kSigma, "sigma of the gyro bias after that"},
      {"odometry.imu_doubt.accel_bias_mps2", &c.accel_bias_mps2, "m/s^2", kSigma, "likewise of the accelerometer bias"},
      {"odometry.imu_doubt.attitude_rad", &c.attitude_rad, "rad", kSigma, "sigma by which the attitude is worse than was thought"},
      {"odometry.imu_doubt.better_inlier_share", &c.better_inlier_share, "", kShare,
       "so much of a scan agrees with the map without the IMU, and"},
      {"odometry.imu_doubt.better_inlier_gain", &c.better_inlier_gain, "", {1, 100},
       "so many times the points that agree with it: fused without the IMU in any case"},
      {"odometry.imu_doubt.after_clock_s", &c.after_clock_s, "s", {0, 1e4},
       "the IMU is not doubted for so long after a clock was unsure: stamps were wrong rather than values"},
      {"odometry.imu_doubt.after_gap_s", &c.after_gap_s, "s", {0, 1e4},
       "nor after the IMU was silent by a scan that fits: the ones before were fused on a guessed motion"},
  };
}

Fields standstill_fields(StandstillConfig& c) {
  return {
      {"odometry.standstill.window_s", &c.window_s, "s", kSeconds, "of IMU samples before a scan's end"},
      {"odometry.standstill.gyro_std_rads", &c.gyro_std_rads, "rad/s", kSigma,
       "the vehicle stands: deviation of every axis at most, four times the LSM6DSOX's own noise"},
      {"odometry.standstill.accel_std_mps2", &c.accel_std_mps2, "m/s^2", kSigma, "likewise"},
      {"odometry.standstill.sigma_mps", &c.sigma_mps, "m/s", kSigma, "of the velocity of zero that a scan is then given"},
      {"odometry.standstill.most_mps", &c.most_mps, "m/s", kSigma, "a state that says it moves faster is not told otherwise"},
      {"odometry.standstill.gate_sigmas", &c.gate_sigmas, "", {0.1, 100}, "nor one that is so sure that it moves"},
  };
}

Fields start_fields(StarterConfig& start) {
  InitialisationConfig& c = start.initialisation;
  return {
      {"odometry.start.imu_grace_s", &start.imu_grace_s, "s", {0, 60},
       "the LiDAR waits so long for the first IMU sample, then starts without"},
      {"odometry.start.rest_s", &c.rest_s, "s", kSeconds, "of stillness make a start at rest"},
      {"odometry.start.min_s", &c.min_s, "s", kSeconds, "of any motion make a start while moving"},
      {"odometry.start.still_gyro_std_rads", &c.still_gyro_std_rads, "rad/s", kSigma,
       "stillness: deviation of every axis"},
      {"odometry.start.still_gyro_mean_rads", &c.still_gyro_mean_rads, "rad/s", kSigma,
       "stillness: mean of every axis"},
      {"odometry.start.still_accel_std_mps2", &c.still_accel_std_mps2, "m/s^2", kSigma,
       "stillness: deviation of every axis"},
      {"odometry.start.rest_velocity_mps", &c.rest_velocity_mps, "m/s", kSigma, "first sigma of velocity at rest"},
      {"odometry.start.moving_velocity_mps", &c.moving_velocity_mps, "m/s", kSigma, "likewise moving"},
      {"odometry.start.rest_gyro_bias_rads", &c.rest_gyro_bias_rads, "rad/s", kSigma,
       "first sigma of the gyro bias at rest"},
      {"odometry.start.moving_gyro_bias_rads", &c.moving_gyro_bias_rads, "rad/s", kSigma, "likewise moving"},
      {"odometry.start.accel_bias_mps2", &c.accel_bias_mps2, "m/s^2", kSigma, "first sigma of the accelerometer bias"},
      {"odometry.start.known_gyro_bias_rads", &c.known_gyro_bias_rads, "rad/s", {-kMostKnownBias, kMostKnownBias},
       "of the IMU, calibrated; a checkpoint's goes before; a start at rest measures its own"},
      {"odometry.start.known_accel_bias_mps2", &c.known_accel_bias_mps2, "m/s^2", {-kMostKnownBias, kMostKnownBias},
       "likewise; across the vertical a start cannot measure it"},
      {"odometry.start.known_motion_at_s", &c.known_motion.at_s, "s", {0, 1e10},
       "host clock; 0: not known. How the vehicle moved then, as a checkpoint has it: what follows"},
      {"odometry.start.known_velocity_mps", &c.known_motion.velocity_mps, "m/s", {-100, 100}, "of base, in base"},
      {"odometry.start.known_up", &c.known_motion.up, "", {-1, 1}, "against gravity, unit, in base"},
      {"odometry.start.rest_accel_noise_mps2", &c.rest_accel_noise_mps2, "m/s^2", kSigma,
       "of the window's mean at rest"},
      {"odometry.start.moving_accel_noise_mps2", &c.moving_accel_noise_mps2, "m/s^2", kSigma,
       "true acceleration taken for gravity"},
      {"odometry.start.extrinsic_rotation_rad", &c.extrinsic_rotation_rad, "rad", kSigma,
       "first sigma, when estimated"},
      {"odometry.start.extrinsic_translation_m", &c.extrinsic_translation_m, "m", kSigma, "likewise"},
  };
}

Fields scan_fields(ScanAssemblerConfig& c) {
  SegmenterConfig& s = c.segmenter;
  return {
      {"odometry.scan.max_packet_gap_s", &c.max_packet_gap, "s", kSeconds,
       "more between two packets: the scan is incomplete"},
      {"odometry.scan.max_scan_length_s", &c.max_scan_length, "s", kSeconds, "a scan that lasts longer is cut"},
      {"odometry.scan.max_points", &c.max_points, "", {1000, 1e6}, "of one scan; more are dropped and counted"},
      {"odometry.scan.max_segments", &c.max_segments, "", {1000, 16'384}, "of one scan"},
      {"odometry.scan.segment_max_length_m", &s.max_length_m, "m", kMetres, "chord of a segment"},
      {"odometry.scan.segment_max_step_m", &s.max_step_m, "m", kMetres,
       "between neighbouring returns of a segment, at least"},
      {"odometry.scan.segment_max_step_per_range", &s.max_step_per_range, "", kShare,
       "likewise, in proportion to range"},
      {"odometry.scan.min_range_m", &s.min_range_m, "m", {0, 100}, "nearer returns are the vehicle itself"},
      {"odometry.scan.max_range_m", &s.max_range_m, "m", {1, 200}, "farther returns are not used"},
  };
}

Fields dead_reckoning_fields(DeadReckoningConfig& c) {
  ImuNoise& n = c.imu_noise;
  return {
      {"odometry.imu.gyro_noise_rads_rthz", &n.gyro_noise_rads_rthz, "rad/s/rtHz", kSigma, "white noise density"},
      {"odometry.imu.accel_noise_mps2_rthz", &n.accel_noise_mps2_rthz, "m/s^2/rtHz", kSigma, "white noise density"},
      {"odometry.imu.gyro_bias_walk_rads2_rthz", &n.gyro_bias_walk_rads2_rthz, "rad/s^2/rtHz", kSigma, "random walk"},
      {"odometry.imu.accel_bias_walk_mps3_rthz", &n.accel_bias_walk_mps3_rthz, "m/s^3/rtHz", kSigma, "random walk"},
      {"odometry.imu.gap_s", &c.imu_gap_s, "s", kSeconds,
       "more between two samples: the constant-velocity model fills in"},
      {"odometry.imu.coast_accel_mps2_rthz", &c.coast_accel_mps2_rthz, "m/s^2/rtHz", kSigma, "constant-velocity model"},
      {"odometry.imu.coast_gyro_rads_rthz", &c.coast_gyro_rads_rthz, "rad/s/rtHz", kSigma, "constant-velocity model"},
      {"odometry.imu.clipped_accel_mps2_rthz", &c.clipped_accel_mps2_rthz, "m/s^2/rtHz", kSigma,
       "while a sample is clipped"},
      {"odometry.imu.clipped_gyro_rads_rthz", &c.clipped_gyro_rads_rthz, "rad/s/rtHz", kSigma,
       "while a sample is clipped"},
  };
}

Fields map_fields(PlaneMapConfig& c) {
  return {
      {"odometry.map.voxel_size_m", &c.voxel_size_m, "m", {0.05, 5}, "edge of a voxel of the local map"},
      {"odometry.map.max_voxels", &c.max_voxels, "", {1000, 1e7}, "bounds the memory; the farthest are forgotten"},
      {"odometry.map.max_distance_m",
       &c.max_distance_m,
       "m",
       {50, 1e4},
       "half the cube that is kept around the vehicle; what lies beyond is for closures to find again"},
      {"odometry.map.min_distance_m", &c.min_distance_m, "m", {20, 1e4}, "likewise when the map is nearly full"},
      {"odometry.map.viewpoint_distance_m", &c.viewpoint_distance_m, "m", {0.01, 10},
       "a scan enters the map when it was taken so far from the last that did"},
      {"odometry.map.viewpoint_angle_rad", &c.viewpoint_angle_rad, "rad", {0.001, 3.2}, "or turned so far from it"},
      {"odometry.map.near_voxels", &c.near.voxels, "", {3, 16}, "voxels that make a plane"},
      {"odometry.map.near_radius_m", &c.near.radius_m, "m", {0.1, 10}, "how far they may lie from its middle"},
      {"odometry.map.wide_voxels", &c.wide.voxels, "", {3, 16}, "likewise where the near ones leave the tilt open"},
      {"odometry.map.wide_radius_m", &c.wide.radius_m, "m", {0.1, 10}, "likewise"},
      {"odometry.map.near_tilt_rad", &c.near_tilt_rad, "rad", kSigma, "sigma of a normal that calls for the wide ones"},
      {"odometry.map.max_tilt_rad", &c.max_tilt_rad, "rad", kSigma, "sigma of a normal that makes no plane"},
      {"odometry.map.max_voxel_weight", &c.max_voxel_weight, "", kCount,
       "points that a voxel takes before it is frozen"},
      {"odometry.map.min_plane_points", &c.min_plane_points, "", {3, 1000}, "fewer make no plane"},
      {"odometry.map.max_plane_thickness_m", &c.max_plane_thickness_m, "m", kMetres,
       "RMS distance of the points from their plane"},
      {"odometry.map.min_plane_extent_m", &c.min_plane_extent_m, "m", kMetres, "RMS extent along the narrower side"},
  };
}

Fields registration_fields(ScanRegistrationConfig& c) {
  PointToPlaneConfig& p = c.point_to_plane;
  IeskfConfig& u = c.update;
  return {
      {"odometry.update.max_points", &c.max_points, "", {100, 16'384}, "segments that take part in one update"},
      {"odometry.update.range_sigma_m", &p.range_sigma_m, "m", kSigma, "of one return"},
      {"odometry.update.floor_sigma_m", &p.floor_sigma_m, "m", kSigma, "of a residual: what averaging cannot remove"},
      {"odometry.update.robust_scale", &p.robust_scale, "", kSigma, "sigmas at which a residual's weight is one half"},
      {"odometry.update.gate_sigmas", &p.gate_sigmas, "", kSigma, "residuals beyond are not used"},
      {"odometry.update.max_residual_m", &p.max_residual_m, "m", kMetres, "likewise in any case"},
      {"odometry.update.least_view_distance_m", &p.least_view_distance_m, "m", {0, 10},
       "a plane nearer to the sensor than this cannot be seen: it is one laser's sweep across an edge"},
      {"odometry.update.least_view_sine", &p.least_view_sine, "", kShare, "likewise, of the angle between beam and plane"},
      {"odometry.update.max_iterations", &u.max_iterations, "", {1, 50}, "of one scan"},
      {"odometry.update.max_iterations_unsure", &u.max_iterations_unsure, "", {1, 100},
       "while the prior is less sure than associate_again_m"},
      {"odometry.update.converged_translation_m", &u.converged_translation_m, "m", kSigma,
       "smaller steps end the iteration"},
      {"odometry.update.converged_rotation_rad", &u.converged_rotation_rad, "rad", kSigma, "likewise"},
      {"odometry.update.associate_again_m", &u.associate_again_m, "m", kSigma,
       "points that moved further are associated anew"},
      {"odometry.update.min_inliers", &u.min_inliers, "", kCount, "fewer: the scan is not fused"},
      {"odometry.update.min_inlier_share", &u.min_inlier_share, "", kShare, "of the points with a plane; likewise"},
      {"odometry.update.information_scale",
       &u.information_scale,
       "",
       {1e-4, 1},
       "share of residuals that are independent"},
      {"odometry.update.degenerate_noise_ratio",
       &u.degenerate_noise_ratio,
       "",
       {0, 1e6},
       "information over what noisy normals fake, at least"},
      {"odometry.update.degenerate_share", &u.degenerate_share, "", kShare, "of all residuals' information, at least"},
      {"odometry.update.degenerate_sigma_m", &u.degenerate_sigma_m, "m", {1e-4, 1},
       "of one scan in the other directions while one is free"},
      {"odometry.update.skewed_sigma_m", &c.skewed_sigma_m, "m", {0, 10},
       "of the first scan after a gap that left the prior unsure; it does not enter the map either"},
      {"odometry.update.guessed_sigma_m", &c.guessed_sigma_m, "m", {0, 10},
       "of a scan in whose time the IMU was silent, or its biases not known"},
      {"odometry.update.estimate_extrinsic",
       &u.estimate_extrinsic,
       "",
       {},
       "refine the LiDAR's place relative to the IMU"},
  };
}

}  // namespace

Fields odometry_fields(OdometryConfig& c) {
  Fields fields = facade_fields(c);
  append(fields, drift_fields(c.fusion.map_drift));
  append(fields, start_fields(c.start));
  append(fields, moving_start_fields(c.fusion.velocity_search));
  append(fields, sanity_fields(c.imu.sanity));
  append(fields, doubt_fields(c.imu_doubt));
  append(fields, standstill_fields(c.standstill));
  append(fields, scan_fields(c.scans.assembler));
  append(fields, dead_reckoning_fields(c.dead_reckoning));
  append(fields, map_fields(c.fusion.registration.map));
  append(fields, registration_fields(c.fusion.registration));
  return fields;
}

}  // namespace slamd
