#include "estimator/odometry/scan_queue.hpp"

#include <bit>
#include <span>

namespace slamd {

namespace {

/// FNV-1a over the scan's first points: equal for a frozen picture, whatever its stamps; 0 without points. The noise of a
/// working sensor never repeats.
std::uint64_t fingerprint_of(const Scan& scan) {
  constexpr std::size_t kPoints = 512;
  std::uint64_t hash = 0;
  for (const LidarPoint& point : std::span{scan.points}.first(std::min(kPoints, scan.points.size()))) {
    for (const float x : {point.x, point.y, point.z}) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 1'099'511'628'211U;
  }
  return hash;
}

}  // namespace

ScanQueue::ScanQueue(const ScanQueueConfig& config)
    : imu_deadline_{from_seconds(config.imu_deadline_s)}, assembler_{config.assembler} {
  pending_.points.reserve(config.assembler.max_points);
  pending_.segments.reserve(config.assembler.max_segments);
}

void ScanQueue::add(const LidarPacket& packet) {
  if (packet.time + packet.span > packet.arrival + kMostAhead) {
    ++stats_.packets_in_future;
    clock_doubt_.raise(packet.arrival);
    return;
  }
  if (packet.clock_unsure) clock_doubt_.raise(packet.arrival);
  if (!assembler_.add(packet)) return;
  if (has_pending_) ++stats_.overtaken;
  assembler_.take(pending_);
  ++stats_.finished;
  const std::uint64_t before = fingerprint_;
  fingerprint_ = fingerprint_of(pending_);
  has_pending_ = fingerprint_ == 0 || fingerprint_ != before;
  if (!has_pending_) ++stats_.repeated;
}

bool ScanQueue::is_due(const ImuIntake& imu, HostTime now) const {
  if (!has_pending_) return false;
  return imu.covers(pending_.end) || !imu.is_alive(pending_.end) || now - pending_.arrival > imu_deadline_;
}

const Scan& ScanQueue::take() {
  has_pending_ = false;
  return pending_;
}

Duration ScanQueue::latency() const { return pending_.end - pending_.begin + imu_deadline_; }

}  // namespace slamd
