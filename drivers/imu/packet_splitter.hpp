#pragma once
// Finds packets in the IMU board's byte stream by their delimiter. What is in them is for firmware/protocol to say.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/protocol/imu_frame.hpp"
#include "firmware/protocol/packet.hpp"

namespace slamd {

/// Between two delimiters, without them.
struct SplitPacket {
  std::span<const std::uint8_t> bytes;  // valid until the next take(); empty when the packet is longer than any may be
  std::size_t size = 0;                 // as it stood in the stream, at least 1
};

/// One thread uses an instance; no allocation.
class PacketSplitter {
 public:
  /// One byte; returns the packet that it ends. Empty packets are skipped.
  std::optional<SplitPacket> take(std::uint8_t byte) {
    if (byte != kImuFrameDelimiter) {
      if (size_ < packet_.size()) packet_[size_] = byte;
      ++size_;
      return std::nullopt;
    }
    const std::size_t size = size_;
    size_ = 0;
    if (size == 0) return std::nullopt;
    return SplitPacket{std::span{packet_}.first(size > packet_.size() ? 0 : size), size};
  }

 private:
  std::array<std::uint8_t, kMaxPacketBytes> packet_{};
  std::size_t size_ = 0;  // since the last delimiter, also what did not fit
};

}  // namespace slamd
