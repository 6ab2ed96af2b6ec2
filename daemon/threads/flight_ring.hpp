#pragma once
// The newest reads of one wire in memory, as many as its span and its bytes allow. One thread adds, any takes a copy; not for
// real-time threads: those hand over through a WireTap.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "drivers/io/pcap_sink.hpp"

namespace slamd {

class FlightRing {
 public:
  /// Chunks are forgotten as a whole: a little less than `bytes` and a little more than `span` is kept.
  FlightRing(Duration span, std::size_t bytes);

  void add(const UdpPacket& read);

  /// What is kept at this moment; nothing is copied, and it stays as it is.
  struct Chunk {
    HostTime newest;
    std::vector<std::uint8_t> bytes;  // each read: its head, then its payload
  };
  using Snapshot = std::vector<std::shared_ptr<const Chunk>>;
  Snapshot snapshot();

  /// Any thread.
  std::size_t bytes() const;

  /// Writes the reads of one chunk.
  static void write(const Chunk& chunk, PcapSink& file);

  static constexpr std::size_t kChunkBytes = 256U * 1024;

 private:
  void begin_chunk();

  const Duration span_;
  const std::size_t most_chunks_;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Chunk>> chunks_;  // the newest is being filled
  bool sealed_ = true;                          // a snapshot has the newest one: nothing may be added to it
};

}  // namespace slamd
