#pragma once
// When each VLP-16 laser fires, relative to its packet's stamp. Constants only. Source: VLP-16 User Manual,
// section 9.3.

#include <chrono>
#include <cstddef>

#include "drivers/velodyne/vlp16_packet.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

constexpr Duration kVlp16Sequence{55'296};            // sixteen firings and the recharge
constexpr Duration kVlp16Laser{2'304};                // from one laser to the next
constexpr Duration kVlp16Block = 2 * kVlp16Sequence;  // a block holds two sequences
constexpr std::size_t kVlp16Channels = 2 * kVlp16Lasers;

/// Firing time of channel 0..31 after its block's first firing.
constexpr Duration channel_offset(std::size_t channel) {
  return static_cast<int>(channel / kVlp16Lasers) * kVlp16Sequence +
         static_cast<int>(channel % kVlp16Lasers) * kVlp16Laser;
}

/// Blocks fired at different times: the two of a dual-return pair are the same firings.
constexpr std::size_t blocks_in_time(Vlp16ReturnMode mode) {
  return mode == Vlp16ReturnMode::kDual ? kVlp16Blocks / 2 : kVlp16Blocks;
}

/// From a packet's first firing to the end of its last sequence, which is also the time between two packets:
/// 1327.104 us, dual return 663.552 us.
constexpr Duration packet_span(Vlp16ReturnMode mode) {
  return static_cast<int>(blocks_in_time(mode)) * kVlp16Block;
}

}  // namespace slamd
