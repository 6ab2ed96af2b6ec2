#include "estimator/graph/map_link.hpp"

#include <numbers>

namespace slamd {

namespace {

constexpr double kAnywhere_m = 1.0e3;
constexpr double kAnyHeading_rad = std::numbers::pi;

}  // namespace

NavState unplaced(NavState state) {
  state.reasons |= bit(StatusReason::kRelocalising);
  if (state.status == TrackingStatus::kTracking) state.status = TrackingStatus::kDegraded;
  state.covariance.diagonal().head<3>().array() += kAnywhere_m * kAnywhere_m;
  state.covariance.diagonal().tail<3>().array() += kAnyHeading_rad * kAnyHeading_rad;
  return state;
}

}  // namespace slamd
