#pragma once
// Finds answers and measurement packets in the bytes that an RPLIDAR sends, after any garbage, across lost bytes and a restart in the
// middle. It sends nothing and computes no angle.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/rplidar/rplidar_protocol.hpp"

namespace slamd {

/// One whole answer or packet of a stream; its bytes live until the reader's next call.
struct RplidarPacket {
  RplidarAnswer answer;
  std::span<const std::uint8_t> bytes;  // empty: a stream begins
};

/// Counters since construction.
struct RplidarReaderStats {
  std::uint64_t answers = 0;
  std::uint64_t packets = 0;       // of streams
  std::uint64_t bad_checksum = 0;  // capsules
  std::uint64_t garbage_bytes = 0;
};

/// One thread uses an instance; no allocation. Takes any split of the stream.
class RplidarReader {
 public:
  /// One byte; the packet that it completes.
  std::optional<RplidarPacket> take(std::uint8_t byte);
  /// The port was opened anew: what was begun is forgotten, and no stream runs.
  void restart();

  const RplidarReaderStats& stats() const { return stats_; }

 private:
  std::optional<RplidarPacket> try_descriptor();
  std::optional<RplidarPacket> try_answer();
  std::optional<RplidarPacket> try_stream();
  bool is_packet() const;
  void drop(std::size_t bytes);

  std::array<std::uint8_t, kRplidarBoostBytes> buffer_{};
  std::size_t size_ = 0;
  std::array<std::uint8_t, kRplidarBoostBytes> given_{};
  std::optional<RplidarDescriptor> awaited_;  // a single answer
  std::optional<RplidarDescriptor> stream_;
  RplidarReaderStats stats_;
};

}  // namespace slamd
