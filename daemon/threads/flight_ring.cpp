#include "daemon/threads/flight_ring.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace slamd {
namespace {

/// Before each payload.
struct Head {
  std::int64_t arrival_ns;
  std::uint32_t size;
  std::uint16_t source_port;
  std::uint16_t destination_port;
  IpAddress source;
};
static_assert(std::is_trivially_copyable_v<Head>);

}  // namespace

FlightRing::FlightRing(Duration span, std::size_t bytes)
    : span_{span}, most_chunks_{std::max<std::size_t>(bytes / kChunkBytes, 2)} {}

void FlightRing::add(const UdpPacket& read) {
  const Head head{to_ns(read.arrival), static_cast<std::uint32_t>(read.payload.size()), read.source_port,
                  read.destination_port, read.source};
  const std::lock_guard lock{mutex_};
  if (sealed_ || chunks_.back()->bytes.size() + sizeof head + read.payload.size() > kChunkBytes) begin_chunk();
  Chunk& chunk = *chunks_.back();
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&head);
  chunk.bytes.insert(chunk.bytes.end(), raw, raw + sizeof head);
  chunk.bytes.insert(chunk.bytes.end(), read.payload.begin(), read.payload.end());
  chunk.newest = read.arrival;
  const auto old = [&](const std::shared_ptr<Chunk>& c) { return read.arrival - c->newest > span_; };
  while (chunks_.size() > 1 && old(chunks_.front())) chunks_.erase(chunks_.begin());
}

/// In the memory of the one that is forgotten, if nobody reads it.
void FlightRing::begin_chunk() {
  std::shared_ptr<Chunk> chunk;
  if (chunks_.size() >= most_chunks_) {
    chunk = std::move(chunks_.front());
    chunks_.erase(chunks_.begin());
  }
  if (chunk == nullptr || chunk.use_count() > 1) chunk = std::make_shared<Chunk>();
  chunk->bytes.clear();
  chunk->bytes.reserve(kChunkBytes);
  chunks_.push_back(std::move(chunk));
  sealed_ = false;
}

FlightRing::Snapshot FlightRing::snapshot() {
  const std::lock_guard lock{mutex_};
  sealed_ = true;
  return {chunks_.begin(), chunks_.end()};
}

std::size_t FlightRing::bytes() const {
  const std::lock_guard lock{mutex_};
  std::size_t bytes = 0;
  for (const auto& chunk : chunks_) bytes += chunk->bytes.size();
  return bytes;
}

void FlightRing::write(const Chunk& chunk, PcapSink& file) {
  for (std::size_t at = 0; at < chunk.bytes.size();) {
    Head head;
    std::memcpy(&head, chunk.bytes.data() + at, sizeof head);
    at += sizeof head;
    file.write({.payload = std::span{chunk.bytes}.subspan(at, head.size),
                .arrival = from_ns<HostTime>(head.arrival_ns),
                .source = head.source,
                .source_port = head.source_port,
                .destination_port = head.destination_port});
    at += head.size;
  }
}

}  // namespace slamd
