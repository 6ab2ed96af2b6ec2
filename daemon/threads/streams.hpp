#pragma once
// Every stream between the daemon's threads, with its one writer and one reader. No thread waits on any of them.

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "daemon/inject/fault_switch.hpp"
#include "daemon/ring/spsc_ring.hpp"
#include "daemon/ring/triple_buffer.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "estimator/filter/inertial_state.hpp"
#include "estimator/graph/map_link.hpp"
#include "estimator/grid/planar_odometry.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/keyframe.hpp"
#include "estimator/types/laser_scan.hpp"
#include "estimator/types/lidar_packet.hpp"
#include "estimator/types/wheel_odometry.hpp"

namespace slamd {

/// The estimator's newest state as the predictor needs it.
struct Posterior {
  FilterSnapshot snapshot;
  NavState state;
};

struct Streams {
  static constexpr std::size_t kMaxKeyframePoints = 65'536;

  SpscRing<LidarPacket> lidar{512};   // lidar thread -> estimator; 0.7 s of single-return packets
  SpscRing<ImuSample> imu{1024};      // imu thread -> estimator; 5 s
  SpscRing<GnssFix> gnss{64};         // gnss thread -> estimator
  SpscRing<WheelOdometry> wheel{512}; // wheel thread -> estimator; 5 s at 100 Hz
  SpscRing<LaserScan> laser{8};       // thread of a 2D LiDAR -> estimator
  TripleBuffer<Posterior> posterior;  // estimator -> imu thread
  TripleBuffer<MapLink> map_link;     // mapping -> imu thread; nothing before the first correction
  SpscRing<Keyframe> keyframes{16, [](Keyframe& slot) { slot.points.reserve(kMaxKeyframePoints); }};  // -> mapping
  SpscRing<PlanarKeyframe> planar_keyframes{256};              // estimator -> planar mapping
  SpscRing<StampedPose> path{256};                             // estimator -> mapping; one pose a scan
  SpscRing<GnssFix> fixes{64};                                 // estimator -> mapping; in the order of events
  FaultBoard faults;                                           // server -> driver threads
  std::atomic<std::int64_t> utc_offset_ns{kUtcOffsetUnknown};  // gnss thread -> imu thread; UTC minus host time
};

}  // namespace slamd
