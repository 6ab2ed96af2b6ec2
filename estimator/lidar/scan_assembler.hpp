#pragma once
// Cuts the stream of packets into revolutions. A revolution begins at the azimuth where the first packet began, so that
// no part of the first turn is lost and the sensor's zero has no special meaning.

#include <optional>

#include "estimator/lidar/segmenter.hpp"
#include "estimator/types/scan.hpp"

namespace slamd {

struct ScanAssemblerConfig {
  SegmenterConfig segmenter;
  Duration max_packet_gap = std::chrono::milliseconds{5};   // more between two packets: the scan is incomplete
  Duration max_scan_length = std::chrono::milliseconds{250};  // slower than 300 rpm: cut all the same
  std::size_t max_points = 65'536;
  std::size_t max_segments = 16'384;
};

class ScanAssembler {
 public:
  explicit ScanAssembler(const ScanAssemblerConfig& config);

  /// Takes one packet in order of its time. True when the packet completed a revolution: take it with take().
  bool add(const LidarPacket& packet);
  /// Ends the open revolution, for instance when the sensor went silent. True when there was one to take.
  bool finish();
  /// Swaps the finished scan with `scan`, whose memory is used again.
  void take(Scan& scan);

  /// Points that were not finite or for which there was no room.
  std::uint64_t points_dropped() const { return points_dropped_; }

 private:
  void begin(const LidarPacket& packet);
  void append(const LidarPacket& packet);
  void close();

  ScanAssemblerConfig config_;
  Segmenter segmenter_;
  Scan open_;
  Scan finished_;
  std::optional<std::uint16_t> cut_azimuth_cdeg_;
  std::int32_t turned_cdeg_ = 0;  // since the revolution's begin
  std::uint16_t last_azimuth_cdeg_ = 0;
  std::uint64_t points_dropped_ = 0;
  bool is_open_ = false;
};

}  // namespace slamd
