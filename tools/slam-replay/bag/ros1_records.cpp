#include "tools/slam-replay/bag/ros1_records.hpp"

#include <algorithm>

#include "drivers/io/byte_reader.hpp"

namespace slamd::replay {
namespace {

constexpr std::uint32_t kMostHeadBytes = 65'536;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

/// A little-endian number of exactly so many bytes; nothing otherwise.
std::optional<std::uint64_t> number(std::span<const std::uint8_t> fields, std::string_view name, std::size_t bytes) {
  const std::optional<std::string_view> value = ros1_field(fields, name);
  if (!value || value->size() != bytes) return std::nullopt;
  std::uint64_t found = 0;
  for (std::size_t i = bytes; i-- > 0;) found = found << 8U | static_cast<std::uint8_t>((*value)[i]);
  return found;
}

bool read_message(std::span<const std::uint8_t> head, Ros1Record& record) {
  const auto connection = number(head, "conn", 4);
  const auto time = number(head, "time", 8);  // seconds, then nanoseconds
  if (!connection || !time) return false;
  record.connection = static_cast<std::uint32_t>(*connection);
  const auto nanoseconds = static_cast<std::int64_t>(*time >> 32U);
  record.time_ns = static_cast<std::int64_t>(*time & 0xFFFFFFFFU) * kNsPerSecond + nanoseconds;
  return nanoseconds < kNsPerSecond;
}

bool read_connection(std::span<const std::uint8_t> head, Ros1Record& record) {
  const auto connection = number(head, "conn", 4);
  const auto topic = ros1_field(head, "topic");
  if (!connection || !topic) return false;
  record.connection = static_cast<std::uint32_t>(*connection);
  record.topic = *topic;
  return true;
}

bool read_chunk(std::span<const std::uint8_t> head, Ros1Record& record) {
  const auto size = number(head, "size", 4);
  const auto name = ros1_field(head, "compression");
  if (!size || !name) return false;
  record.chunk_bytes = static_cast<std::uint32_t>(*size);
  record.compression = compression_of(*name);
  return true;
}

bool read_head(std::span<const std::uint8_t> head, Ros1Record& record) {
  const auto op = number(head, "op", 1);
  if (!op) return false;
  record.op = static_cast<Ros1Op>(*op);
  switch (record.op) {
    case Ros1Op::kMessage: return read_message(head, record);
    case Ros1Op::kConnection: return read_connection(head, record);
    case Ros1Op::kChunk: return read_chunk(head, record);
    case Ros1Op::kBagHeader: record.index_at = number(head, "index_pos", 8).value_or(0); return true;
    case Ros1Op::kIndex:
    case Ros1Op::kChunkInfo: return true;
    case Ros1Op::kNone: break;
  }
  return false;
}

}  // namespace

std::optional<std::string_view> ros1_field(std::span<const std::uint8_t> fields, std::string_view name) {
  ByteReader from{fields};
  while (from.remaining() > 0) {
    const auto bytes = from.take(from.u32_le());
    if (!from.ok()) return std::nullopt;
    const std::string_view field{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    if (field.size() > name.size() && field[name.size()] == '=' && field.starts_with(name)) return field.substr(name.size() + 1);
  }
  return std::nullopt;
}

std::optional<Ros1Record> parse_ros1_record(std::span<const std::uint8_t> bytes) {
  ByteReader from{bytes};
  const std::uint32_t head_bytes = from.u32_le();
  if (!from.ok() || head_bytes > kMostHeadBytes) return std::nullopt;
  const auto head = from.take(head_bytes);
  const std::uint32_t body_bytes = from.u32_le();
  Ros1Record record;
  if (!from.ok() || !read_head(head, record)) return std::nullopt;
  record.is_whole = body_bytes <= from.remaining();
  record.body = from.take(std::min<std::size_t>(body_bytes, from.remaining()));
  record.bytes = from.position();
  return record;
}

}  // namespace slamd::replay
