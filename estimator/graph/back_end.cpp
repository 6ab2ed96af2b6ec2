#include "estimator/graph/back_end.hpp"

namespace slamd {

Mapper make_mapper(const BackEndConfig& config, const VehicleGeometry& vehicle) {
  std::unique_ptr<LoopSource> loops;
  if (config.use_loops) loops = std::make_unique<LoopCloser>(config.loops, vehicle.T_base_lidar.translation);
  std::unique_ptr<PositionSource> positions;
  if (config.use_gps) positions = std::make_unique<GnssAlignment>(config.gps, vehicle.p_base_antenna);
  return Mapper{config.mapper, std::move(loops), std::move(positions)};
}

Relocaliser make_relocaliser(const BackEndConfig& config, const VehicleGeometry& vehicle) {
  return {config.relocaliser, [=] { return make_mapper(config, vehicle); }, vehicle.T_base_lidar.translation};
}

}  // namespace slamd
