#pragma once
// Topics of PointCloud2 as LiDAR packets: each cloud is a revolution, its points in order of time and cut into packets. Decodes no
// device's bytes (drivers).

#include <memory>

#include "estimator/types/lidar_packet.hpp"
#include "tools/slam-replay/bag/cloud_timing.hpp"
#include "tools/slam-replay/bag/topic.hpp"

namespace slamd::replay {

struct CloudStreamConfig {
  CloudTimingConfig timing;
  double min_range_m = 0.5, max_range_m = 130.0;
};

/// A packet's azimuths are its share of the sweep, whichever way the sensor turns: the scan assembler cuts where the clouds do. The
/// packets of a cloud arrive when its last point has been measured.
std::unique_ptr<Stream<LidarPacket>> cloud_stream(TopicSource topic, const CloudStreamConfig& config);

}  // namespace slamd::replay
