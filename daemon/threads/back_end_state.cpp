#include "daemon/threads/back_end_state.hpp"

#include <nlohmann/json.hpp>

namespace slamd {
namespace {

using nlohmann::json;

json pose_json(const Pose& T) {
  const auto& t = T.translation;
  const auto& q = T.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}}, {"rotation_quat_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

json enu_json(const GraphSolution& solution) {
  if (!solution.enu_valid) return nullptr;
  const EnuOrigin& origin = solution.enu_origin;
  const Eigen::Vector4d sigma = solution.enu.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {{"origin_lat_deg", origin.latitude_deg},
          {"origin_lon_deg", origin.longitude_deg},
          {"origin_ellipsoid_height_m", origin.ellipsoid_height_m},
          {"T_enu_map", pose_json(solution.enu.T_enu_map())},
          {"translation_sigma_m", {sigma[0], sigma[1], sigma[2]}},
          {"yaw_sigma_rad", sigma[3]}};
}

json gnss_json(const std::optional<GnssState>& gnss) {
  if (!gnss) return nullptr;
  return {{"trust", name(gnss->trust)},
          {"latency_correction_s", gnss->latency.correction_s},
          {"latency_sigma_s", gnss->latency.sigma_s}};
}

}  // namespace

BackEndState state_of(const Relocaliser& back_end, HostTime now) {
  const Mapper& mapper = back_end.mapper();
  BackEndState state{.solution = mapper.solution(),
                     .gnss = {},
                     .link = back_end.link(),
                     .relocalisation = back_end.counts(),
                     .forgotten_clouds = mapper.forgotten_clouds(),
                     .bytes = mapper.bytes(),
                     .byte_budget = mapper.byte_budget(),
                     .left_out_keyframes = mapper.left_out_keyframes()};
  if (const PositionSource* gnss = mapper.positions()) state.gnss = GnssState{gnss->trust(now), gnss->latency()};
  return state;
}

json to_json(const BackEndState& state) {
  const GraphSolution& solution = *state.solution;
  return {{"changes", solution.changes},
          {"keyframes", solution.keyframes.size()},
          {"closures", solution.closures},
          {"gnss_positions", solution.positions},
          {"forgotten_clouds", state.forgotten_clouds},
          {"bytes", state.bytes},
          {"byte_budget", state.byte_budget},
          {"budget_reached", state.left_out_keyframes > 0},
          {"left_out_keyframes", state.left_out_keyframes},
          {"T_map_odom", pose_json(state.link.T_map_odom)},
          {"relocalising", !state.link.known},
          {"relocalised", state.relocalisation.relocalised},
          {"maps_begun_anew", state.relocalisation.begun_anew},
          {"enu", enu_json(solution)},
          {"gnss", gnss_json(state.gnss)}};
}

}  // namespace slamd
