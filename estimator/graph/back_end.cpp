#include "estimator/graph/back_end.hpp"

namespace slamd {

Mapper make_mapper(const BackEndConfig& config, const VehicleGeometry& vehicle) {
  std::unique_ptr<LoopSource> loops;
  if (config.use_loops) loops = std::make_unique<LoopCloser>(config.loops, vehicle.T_base_lidar.translation);
  return Mapper{config.mapper, std::move(loops), nullptr};
}

}  // namespace slamd
