#pragma once
// The bytes of VLP-16 data and position packets: checked, then read in place. No time, no angle and no point is
// computed here (vlp16_decoder does). Source: VLP-16 User Manual 63-9243 Rev. E, chapter 9.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/io/lidar_stats.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

constexpr std::size_t kVlp16PacketBytes = 1206;
constexpr std::size_t kVlp16PositionBytes = 512;
constexpr std::size_t kVlp16Blocks = 12;
constexpr std::size_t kVlp16Lasers = 16;

enum class Vlp16ReturnMode : std::uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };

struct Vlp16Return {
  std::uint16_t distance_2mm;  // 0 = nothing came back
  std::uint8_t intensity;
};

/// A checked data packet; borrows the payload.
struct Vlp16Packet {
  std::span<const std::uint8_t, kVlp16PacketBytes> bytes;
  Vlp16ReturnMode mode;
  std::uint32_t stamp_us;                                // of the first firing, past the hour
  std::array<std::uint16_t, kVlp16Blocks> azimuth_cdeg;  // of each block's first firing, 0..35999

  /// block 0..11, channel 0..31 (two firing sequences of 16 lasers).
  Vlp16Return at(std::size_t block, std::size_t channel) const {
    const std::size_t at = block * 100 + 4 + channel * 3;
    return {static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8)), bytes[at + 2]};
  }
};

struct Vlp16Parsed {
  LidarRejection cause;  // kCount when the packet is good
  Vlp16Packet packet;    // only then
};

/// Checks size, model, return mode, block flags, azimuths (0..35999), stamp (below one hour) and the pairing of
/// dual-return blocks. Any bytes may come in. Pure.
Vlp16Parsed parse_vlp16(std::span<const std::uint8_t> payload);

enum class PpsState : std::uint8_t { kAbsent = 0, kSynchronising = 1, kLocked = 2, kError = 3 };
/// "absent", "synchronising", "locked", "error".
const char* name(PpsState state);

struct Vlp16Position {
  std::uint32_t stamp_us;  // past the hour
  PpsState pps;
  std::string_view nmea;  // without the line end; borrows the payload; empty when the sensor has no receiver
};

/// Reads the payload of a position packet (port 8308). Fails on another size, a stamp of an hour or more, or an unknown
/// PPS state; the sentence is passed on as it is (drivers/gnss checks it).
Result<Vlp16Position> parse_vlp16_position(std::span<const std::uint8_t> payload);

}  // namespace slamd
