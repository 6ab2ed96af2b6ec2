#pragma once
// The driver of whichever spinning LiDAR is configured: the one place that knows there are several. It reads no socket; each model's
// own folder knows its packets.

#include <cstdint>
#include <span>
#include <variant>

#include "drivers/lidar/lidar_model.hpp"
#include "drivers/robosense/airy_decoder.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"

namespace slamd {

/// Of the port beside the data port.
struct LidarSideStats {
  std::uint64_t packets = 0;     // position packets of a VLP-16, device packets of an Airy
  std::uint64_t refused = 0;
  std::uint64_t pps_locked = 0;  // of a VLP-16: said that its clock follows a pulse per second
};

/// One thread. No allocation after construction.
class SpinningLidar {
 public:
  /// model   one that spins: not kRplidarA2
  SpinningLidar(LidarModel model, const LidarDecoderConfig& config);

  /// A payload of the data port, any bytes; see Vlp16Decoder::decode, AiryDecoder::decode.
  const LidarPacket* points(std::span<const std::uint8_t> payload, HostTime arrival);
  /// A payload of the port beside it, any bytes.
  void side(std::span<const std::uint8_t> payload);

  const LidarStats& stats() const;
  const LidarSideStats& side_stats() const { return side_; }
  const ClockSync& clock() const;

 private:
  using Decoder = std::variant<Vlp16Decoder, AiryDecoder>;
  static Decoder make(LidarModel model, const LidarDecoderConfig& config);

  Decoder decoder_;
  LidarSideStats side_;
};

}  // namespace slamd
