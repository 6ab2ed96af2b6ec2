#pragma once
// What waits for the host: samples, of which the oldest go first when it does not read, and replies. It does not send.

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/drop_oldest_queue.hpp"
#include "firmware/protocol/imu_frame.hpp"
#include "firmware/protocol/packet.hpp"

namespace slamd {

/// One packet for the wire, delimiter included.
struct WirePacket {
  std::array<std::uint8_t, kMaxPacketWireBytes> bytes{};
  std::uint8_t size = 0;

  std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
};

class Outbox {
 public:
  static constexpr std::size_t kFrames =
      128;  // 0.6 s: a busy host loses nothing, and what it reads late is not very old
  static constexpr std::size_t kReplies = 4;

  /// Queues a sample's frame, or counts it as dropped when nobody listens.
  void push(const ImuFrame& frame);

  template <std::size_t N>
  void push_reply(const std::array<std::uint8_t, N>& bytes) {
    WirePacket packet;
    for (std::size_t i = 0; i < N; ++i) packet.bytes[i] = bytes[i];
    packet.size = static_cast<std::uint8_t>(N);
    replies_.push(packet);
  }

  /// Somebody listens, or nobody does any more: then the samples that wait are dropped.
  void set_open(bool open);
  bool open() const { return open_; }

  bool empty() const { return frames_.empty() && replies_.empty(); }
  /// The next packet, replies first; not when empty. Frames get the newest count of dropped ones here, so that the
  /// first frame behind a gap tells its size.
  WirePacket next();

  std::uint32_t dropped() const { return dropped_; }
  std::size_t most_frames() const { return most_frames_; }

 private:
  DropOldestQueue<ImuFrame, kFrames> frames_;
  DropOldestQueue<WirePacket, kReplies> replies_;
  std::uint32_t dropped_ = 0;
  std::size_t most_frames_ = 0;
  bool open_ = false;
  bool first_sent_ = false;
};

}  // namespace slamd
