#include "estimator/lidar/scan_assembler.hpp"

#include <cmath>

namespace slamd {

namespace {

constexpr std::int32_t kTurn_cdeg = 36'000;

std::int32_t turn_between(std::uint16_t from_cdeg, std::uint16_t to_cdeg) {
  return (static_cast<std::int32_t>(to_cdeg) - static_cast<std::int32_t>(from_cdeg) + kTurn_cdeg) % kTurn_cdeg;
}

bool is_finite(const LidarPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void reserve(Scan& scan, const ScanAssemblerConfig& config) {
  scan.points.reserve(config.max_points);
  scan.segments.reserve(config.max_segments);
}

}  // namespace

ScanAssembler::ScanAssembler(const ScanAssemblerConfig& config) : config_{config}, segmenter_{config.segmenter} {
  reserve(open_, config_);
  reserve(finished_, config_);
}

bool ScanAssembler::add(const LidarPacket& packet) {
  bool finished = false;
  if (is_open_) {
    turned_cdeg_ += turn_between(last_azimuth_cdeg_, packet.azimuth_begin_cdeg);
    const Duration gap = packet.time - open_.end;
    if (gap > config_.max_packet_gap || gap < -config_.max_packet_gap) open_.complete = false;
    const bool too_long = packet.time - open_.begin > config_.max_scan_length || gap < -config_.max_scan_length;
    // A packet spans some 5 degrees: the cut is at the packet whose begin is nearest to a whole turn.
    const std::int32_t half_packet_cdeg = turn_between(packet.azimuth_begin_cdeg, packet.azimuth_end_cdeg) / 2;
    if (turned_cdeg_ + half_packet_cdeg >= kTurn_cdeg || too_long) finished = finish();
  }
  if (!is_open_) begin(packet);
  append(packet);
  return finished;
}

bool ScanAssembler::finish() {
  if (!is_open_) return false;
  close();
  return true;
}

void ScanAssembler::take(Scan& scan) { std::swap(scan, finished_); }

void ScanAssembler::begin(const LidarPacket& packet) {
  if (!cut_azimuth_cdeg_) cut_azimuth_cdeg_ = packet.azimuth_begin_cdeg;
  // Keeps the cut from creeping: what the last cut was early or late counts for the next revolution.
  const std::int32_t late_cdeg = turn_between(*cut_azimuth_cdeg_, packet.azimuth_begin_cdeg);
  turned_cdeg_ = late_cdeg > kTurn_cdeg / 2 ? late_cdeg - kTurn_cdeg : late_cdeg;
  reserve(open_, config_);  // does nothing but after take() handed in a scan without memory
  open_.begin = packet.time;
  open_.complete = true;
  open_.points.clear();
  open_.segments.clear();
  is_open_ = true;
}

void ScanAssembler::append(const LidarPacket& packet) {
  turned_cdeg_ += turn_between(packet.azimuth_begin_cdeg, packet.azimuth_end_cdeg);
  last_azimuth_cdeg_ = packet.azimuth_end_cdeg;
  open_.end = packet.time + packet.span;
  open_.arrival = packet.arrival;
  const std::int64_t begin_to_packet_ns = (packet.time - open_.begin).count();
  for (std::size_t i = 0; i < packet.point_count; ++i) {
    LidarPoint point = packet.points[i];
    if (!is_finite(point)) {
      ++points_dropped_;
      continue;
    }
    point.time_offset_ns += static_cast<std::int32_t>(begin_to_packet_ns);
    segmenter_.add(point, static_cast<float>(point.time_offset_ns) * 1e-9F, open_.segments);
    if (open_.points.size() < open_.points.capacity()) {
      open_.points.push_back(point);
    } else {
      ++points_dropped_;  // of the cloud; its segment has it all the same, so that no sector is blind
    }
  }
}

void ScanAssembler::close() {
  segmenter_.finish(open_.segments);
  std::swap(open_, finished_);
  is_open_ = false;
}

}  // namespace slamd
