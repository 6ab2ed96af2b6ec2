#include "daemon/threads/map_correction.hpp"

#include "estimator/math/se3.hpp"

namespace slamd {
namespace {

constexpr double kStill = 1e-4;  // m and rad: below that nothing has moved

/// Keyframes that `before` does not have were put where its T_map_odom says.
Pose place_before(const GraphSolution& before, const GraphSolution& now, std::size_t i) {
  return i < before.keyframes.size() ? before.keyframes[i].T_map_base : before.T_map_odom * now.keyframes[i].T_odom_base;
}

}  // namespace

void correct_map(const GraphSolution& solution, const GraphSolution& before, MapStore& map) {
  std::vector<KeyframePose> moved;
  for (std::size_t i = 0; i < solution.keyframes.size(); ++i) {
    const Pose& T_map_base = solution.keyframes[i].T_map_base;
    if (boxminus(T_map_base, place_before(before, solution, i)).norm() > kStill) moved.push_back({i, T_map_base});
  }
  map.move(moved);
  if (!solution.enu_valid) return;
  const EnuOrigin& origin = solution.enu_origin;
  map.set_geo_reference(GeoReference{origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m,
                                     solution.enu.T_enu_map()});
}

}  // namespace slamd
