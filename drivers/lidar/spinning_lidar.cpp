#include "drivers/lidar/spinning_lidar.hpp"

namespace slamd {

SpinningLidar::Decoder SpinningLidar::make(LidarModel model, const LidarDecoderConfig& config) {
  if (model == LidarModel::kAiry) return AiryDecoder{config};
  return Vlp16Decoder{config};
}

SpinningLidar::SpinningLidar(LidarModel model, const LidarDecoderConfig& config) : decoder_{make(model, config)} {}

const LidarPacket* SpinningLidar::points(std::span<const std::uint8_t> payload, HostTime arrival) {
  return std::visit([&](auto& decoder) { return decoder.decode(payload, arrival); }, decoder_);
}

void SpinningLidar::side(std::span<const std::uint8_t> payload) {
  if (auto* airy = std::get_if<AiryDecoder>(&decoder_)) {
    ++(airy->inform(payload) ? side_.packets : side_.refused);
    return;
  }
  const Result<Vlp16Position> position = parse_vlp16_position(payload);
  ++(position ? side_.packets : side_.refused);
  side_.pps_locked += position && position->pps == PpsState::kLocked ? 1 : 0;
}

const LidarStats& SpinningLidar::stats() const {
  return std::visit([](const auto& decoder) -> const LidarStats& { return decoder.stats(); }, decoder_);
}

const ClockSync& SpinningLidar::clock() const {
  return std::visit([](const auto& decoder) -> const ClockSync& { return decoder.clock(); }, decoder_);
}

}  // namespace slamd
