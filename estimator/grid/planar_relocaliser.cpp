#include "estimator/grid/planar_relocaliser.hpp"

#include <algorithm>

namespace slamd {

std::optional<CorrelativeMatch> PlanarRelocaliser::look(const PlanarScan& scan, const PlanarPose& T_map_believed, double unseen_m) {
  const std::size_t stride = std::max<std::size_t>(1, (scan.points.size() + config_.points - 1) / config_.points);
  sample_.clear();
  for (std::size_t i = 0; i < scan.points.size(); i += stride) sample_.push_back(scan.points[i]);
  if (sample_.empty()) return std::nullopt;
  SearchWindow window{.centre = T_map_believed, .half_yaw_rad = config_.half_rad, .least_score = config_.least_score};
  window.half_width_m = std::min(config_.most_half_m, config_.least_half_m + config_.way_share * unseen_m);
  return matcher_.match(likelihood_, sample_, window);
}

}  // namespace slamd
