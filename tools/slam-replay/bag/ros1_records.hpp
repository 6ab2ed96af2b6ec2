#pragma once
// The records of a ROS 1 bag, format 2.0 (wiki.ros.org/Bags/Format/2.0): one at a time, out of bytes. Walks no file
// (ros1_reader.hpp).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/mcap/compression.hpp"

namespace slamd::replay {

inline constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";

enum class Ros1Op : std::uint8_t { kNone = 0, kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

/// One record; its body is cut where the bytes end.
struct Ros1Record {
  Ros1Op op = Ros1Op::kNone;
  std::uint32_t connection = 0;   // of messages and connections
  std::int64_t time_ns = 0;       // of messages
  std::uint64_t index_at = 0;     // of the bag header: where connections and chunk infos begin; 0: it was never closed
  std::uint32_t chunk_bytes = 0;  // of chunks: before compression
  std::optional<Compression> compression;  // of chunks; nothing: an unknown one
  std::string_view topic;         // of connections
  std::span<const std::uint8_t> body;
  std::size_t bytes = 0;          // of the whole record
  bool is_whole = true;
};

/// The record at the begin of `bytes`; nothing when its head is none.
std::optional<Ros1Record> parse_ros1_record(std::span<const std::uint8_t> bytes);

/// Calls visit(record) for the records of the index at the end of a closed bag. False: there is none, or it is not whole.
template <class Visit>
bool visit_ros1_index(std::span<const std::uint8_t> file, Visit&& visit) {
  const auto header = file.size() > kRos1Magic.size() ? parse_ros1_record(file.subspan(kRos1Magic.size())) : std::nullopt;
  if (!header || header->op != Ros1Op::kBagHeader || header->index_at == 0 || header->index_at >= file.size()) return false;
  for (std::size_t at = header->index_at; at < file.size();) {
    const auto record = parse_ros1_record(file.subspan(at));
    if (!record || !record->is_whole) return false;
    at += record->bytes;
    visit(*record);
  }
  return true;
}

/// The value of a field among those of a head or of a connection's body ("topic", "type", ...).
std::optional<std::string_view> ros1_field(std::span<const std::uint8_t> fields, std::string_view name);

}  // namespace slamd::replay
