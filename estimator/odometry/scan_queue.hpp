#pragma once
// LiDAR packets on their way to the filter: made into scans, held back until the IMU covers them or a deadline has passed.
// Holds one finished scan; a newer one overtakes it, and that is counted. Looks into no scan.

#include "estimator/lidar/scan_assembler.hpp"
#include "estimator/odometry/imu_intake.hpp"

namespace slamd {

struct ScanQueueConfig {
  ScanAssemblerConfig assembler;
  double imu_deadline_s = 0.05;   // a scan waits so long for the IMU to cover it
};

struct ScanQueueStats {
  std::uint64_t finished = 0;           // scans made of packets
  std::uint64_t overtaken = 0;          // by the next one, before they were taken
  std::uint64_t repeated = 0;           // the same points to the bit as the scan before: the sensor is stuck
  std::uint64_t packets_in_future = 0;  // stamped later than received
};

class ScanQueue {
 public:
  explicit ScanQueue(const ScanQueueConfig& config);

  /// Takes one packet in order of arrival. No allocation.
  void add(const LidarPacket& packet);
  /// Whether a scan waits that the IMU covers or that need not wait for it any longer.
  bool is_due(const ImuIntake& imu, HostTime now) const;
  bool empty() const { return !has_pending_; }
  /// Of the waiting scan. Not on an empty queue.
  HostTime end() const { return pending_.end; }
  /// The waiting scan; valid until the next add(). Not on an empty queue.
  const Scan& take();

  /// A scan begun now can be fused no sooner than after this time: the newest one's length and its deadline.
  Duration latency() const;
  bool is_clock_unsure(HostTime at) const { return clock_doubt_.holds(at); }
  const ScanQueueStats& stats() const { return stats_; }

 private:
  Duration imu_deadline_;
  ScanAssembler assembler_;
  Scan pending_;
  bool has_pending_ = false;
  std::uint64_t fingerprint_ = 0;  // of pending_'s points
  ClockDoubt clock_doubt_;
  ScanQueueStats stats_;
};

}  // namespace slamd
