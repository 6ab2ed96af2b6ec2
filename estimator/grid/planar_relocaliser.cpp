#include "estimator/grid/planar_relocaliser.hpp"

#include <algorithm>

namespace slamd {

std::optional<CorrelativeMatch> PlanarRelocaliser::look(const PlanarScan& scan, const PlanarPose& T_map_believed) {
  const std::size_t stride = std::max<std::size_t>(1, (scan.points.size() + config_.points - 1) / config_.points);
  sample_.clear();
  for (std::size_t i = 0; i < scan.points.size(); i += stride) sample_.push_back(scan.points[i]);
  if (sample_.empty()) return std::nullopt;
  SearchWindow near{.centre = T_map_believed, .half_width_m = config_.near_m, .half_yaw_rad = config_.near_rad};
  near.least_score = config_.near_score;
  if (const auto found = matcher_.match(likelihood_, sample_, near)) return found;
  SearchWindow far{.centre = T_map_believed, .half_width_m = config_.far_m, .half_yaw_rad = config_.far_rad};
  far.least_score = config_.far_score;
  return matcher_.match(likelihood_, sample_, far);
}

}  // namespace slamd
