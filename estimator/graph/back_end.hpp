#pragma once
// The back end as the daemon and slam-replay use it: which parts it has, their configuration, and a mapper made of them.

#include "estimator/graph/gnss_alignment.hpp"
#include "estimator/graph/loop_closer.hpp"
#include "estimator/graph/mapper.hpp"
#include "estimator/graph/relocaliser.hpp"

namespace slamd {

struct BackEndConfig {
  MapperConfig mapper;
  bool use_loops = true;
  LoopCloserConfig loops;
  bool use_gps = true;
  GnssAlignmentConfig gps;
  RelocaliserConfig relocaliser;
};

/// A mapper with the parts that the configuration asks for.
Mapper make_mapper(const BackEndConfig& config, const VehicleGeometry& vehicle);

/// The whole back end: such mappers, and one map over all pieces of odometry.
Relocaliser make_relocaliser(const BackEndConfig& config, const VehicleGeometry& vehicle);

}  // namespace slamd
