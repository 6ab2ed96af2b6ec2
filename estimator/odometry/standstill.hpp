#pragma once
// A vehicle that stands is known to stand: no vibration in the IMU makes a measurement of zero velocity. Along a corridor, where
// scans tell nothing of it, that is all that is known of the velocity. Carries no state.

#include "estimator/filter/inertial_state.hpp"
#include "estimator/odometry/imu_buffer.hpp"

namespace slamd {

struct StandstillConfig {
  double window_s = 0.5;           // of samples before the scan's end
  double gyro_std_rads = 0.003;    // at most, of every axis: nothing that rolls is so smooth
  double accel_std_mps2 = 0.03;
  double sigma_mps = 0.005;        // of every axis of the velocity, a scan
  double most_mps = 0.5;           // a state that says it moves faster is not told otherwise,
  double gate_sigmas = 3.5;        // nor one that is so sure that it moves
};

/// Whether the samples of the window before `at` are without gap and as quiet as those of a vehicle that stands, perhaps with
/// its motor off. One with a motor that shakes it may stand as well, and is not recognised.
bool is_standing(const StandstillConfig& config, const ImuBuffer& samples, HostTime at);

/// Kalman update of the filter with a velocity of zero; false, and the filter unchanged, where its state contradicts it.
bool update_standstill(const StandstillConfig& config, FilterSnapshot& filter);

}  // namespace slamd
