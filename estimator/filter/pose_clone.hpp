#pragma once
// An earlier pose remembered beside the state, so that the motion since then has a covariance of its own (stochastic
// cloning, Roumeliotis and Burdick 2002). The clone is told to others as it was: later scans do not correct it.

#include "estimator/filter/inertial_state.hpp"

namespace slamd {

/// Makes the present pose the clone.
void take_clone(FilterSnapshot& filter);

/// Covariance of the error e of T_clone_imu: T_true = T * Exp(e), rows 0-2 translation (m), 3-5 rotation (rad), imu frame.
/// The map's drift is not in it.
Matrix6d motion_covariance(const FilterSnapshot& filter);

}  // namespace slamd
