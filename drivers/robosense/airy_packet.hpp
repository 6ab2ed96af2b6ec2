#pragma once
// The bytes of a RoboSense Airy's data packets (MSOP): checked, then read in place. No time in host terms, angle or point is
// computed here (airy_decoder does). Source: Airy User Guide 1.2, chapter on MSOP.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/io/lidar_stats.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

constexpr std::size_t kAiryPacketBytes = 1248;
constexpr std::size_t kAiryBlocks = 8;
constexpr std::size_t kAiryBlockChannels = 48;  // of a block; two blocks are a column
constexpr std::size_t kAiryChannels = 96;
constexpr std::size_t kAiryBlockBytes = 4 + 3 * kAiryBlockChannels;
constexpr std::size_t kAiryHeaderBytes = 42;

enum class AiryReturns : std::uint8_t { kSingle, kDual };

/// Columns of 96 firings in a packet.
constexpr std::size_t airy_columns(AiryReturns returns) { return returns == AiryReturns::kDual ? 2 : 4; }

struct AiryReturn {
  std::uint16_t distance_5mm;  // 0 = nothing came back
  std::uint8_t intensity;
};

/// A checked data packet; borrows the payload.
struct AiryPacket {
  std::span<const std::uint8_t, kAiryPacketBytes> bytes;
  AiryReturns returns;
  DeviceTime stamp;                        // of the first firing, by the sensor's clock
  std::array<std::uint16_t, 4> azimuth_cdeg;  // of each column, 0..35999; the first airy_columns() of them

  /// column 0..3 (dual return 0..1), channel 0..95, which 0..1: of a dual return.
  AiryReturn at(std::size_t column, std::size_t channel, std::size_t which = 0) const {
    const std::size_t stride = kAiryBlocks / airy_columns(returns);
    const std::size_t block = column * stride + 2 * which + channel / kAiryBlockChannels;
    const std::size_t at = kAiryHeaderBytes + block * kAiryBlockBytes + 4 + channel % kAiryBlockChannels * 3;
    constexpr unsigned kDistanceBits = 0x3FFF;  // the two above tell the quality of the echo
    return {static_cast<std::uint16_t>(((static_cast<unsigned>(bytes[at]) << 8U) | bytes[at + 1]) & kDistanceBits), bytes[at + 2]};
  }
};

struct AiryParsed {
  LidarRejection cause;  // kCount when the packet is good
  AiryPacket packet;     // only then
};

/// Checks size, header, kind of data, number of channels, stamp, block flags, azimuths (0..35999), and that the blocks of the same
/// firings agree. The bytes after the blocks carry nothing that is documented and are not looked at. Any bytes may come in. Pure.
AiryParsed parse_airy(std::span<const std::uint8_t> payload);

}  // namespace slamd
