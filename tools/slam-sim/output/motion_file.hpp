#pragma once
// Writes the exact motion of the IMU as CSV, for something else that plays the IMU. Not what a sensor measures: no noise.

#include <filesystem>

#include "tools/slam-sim/sensors/simulation.hpp"

namespace slamd::sim {

/// t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2 in the IMU's axes, 1,000 lines a second, from the start of the drive
/// (host time start_ns) to its end. The file appears complete, under its name. Throws std::runtime_error with path and
/// reason.
void write_imu_motion(const std::filesystem::path& path, const Simulation& simulation, double gravity_mps2,
                      std::int64_t start_ns);

}  // namespace slamd::sim
