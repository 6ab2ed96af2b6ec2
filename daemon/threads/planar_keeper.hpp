#pragma once
// Keeps the planar map on disk: the newest of it whole now and then, each keyframe added at its end in between. Called by the
// planar mapping thread, which may wait for a disk.

#include <string>

#include "daemon/store/planar_checkpoint.hpp"
#include "daemon/threads/checkpoint_thread.hpp"
#include "estimator/grid/planar_mapper.hpp"

namespace slamd {

/// Of the one file in the checkpoints' folder; empty: no checkpoints.
std::string planar_checkpoint_path(const CheckpointConfig& config);

class PlanarKeeper {
 public:
  PlanarKeeper(const CheckpointConfig& config, const VehicleGeometry& vehicle);

  /// Brings the file up to the mapper's newest keyframe.
  void keep(const PlanarMapper& mapper, HostTime now);
  /// The map begins anew: what is kept is of no use.
  void forget() { next_whole_ = HostTime{}; }
  const CheckpointReport& report() const { return report_; }

 private:
  void write_whole(const PlanarMapper& mapper);
  void add_newest(const PlanarMapper& mapper);
  void tell(const Result<void>& done, std::size_t bytes);

  std::string path_;
  CheckpointConfig config_;
  VehicleGeometry vehicle_;
  HostTime next_whole_;
  HostTime kept_;              // the newest keyframe in the file
  CheckpointReport report_;
};

}  // namespace slamd
