#include "drivers/mcap/mcap_records.hpp"

namespace slamd {
namespace {

constexpr std::uint32_t kLongestCompressionName = 16;

std::string text(ByteReader& from) {
  const auto bytes = from.take(from.u32_le());
  return {bytes.begin(), bytes.end()};
}

std::map<std::string, std::string> text_map(ByteReader& from) {
  std::map<std::string, std::string> map;
  const auto bytes = from.take(from.u32_le());
  ByteReader entries{bytes};
  while (entries.ok() && entries.remaining() > 0) {
    const std::string key = text(entries);
    map[key] = text(entries);
  }
  if (!entries.ok()) from.skip(from.remaining() + 1);  // fails
  return map;
}

}  // namespace

std::optional<McapSchema> parse_schema(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  McapSchema schema;
  schema.id = from.u16_le();
  schema.name = text(from);
  schema.encoding = text(from);
  schema.text = text(from);
  if (!from.ok() || schema.id == 0) return std::nullopt;
  return schema;
}

std::optional<McapChannel> parse_channel(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  McapChannel channel;
  channel.id = from.u16_le();
  channel.schema_id = from.u16_le();
  channel.topic = text(from);
  channel.encoding = text(from);
  channel.metadata = text_map(from);
  if (!from.ok()) return std::nullopt;
  return channel;
}

std::optional<McapMessage> parse_message(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  McapMessage message;
  message.channel_id = from.u16_le();
  message.sequence = from.u32_le();
  message.log_time_ns = from.u64_le();
  message.publish_time_ns = from.u64_le();
  if (!from.ok()) return std::nullopt;
  message.bytes = from.take(from.remaining());
  return message;
}

std::optional<McapChunk> parse_chunk(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  McapChunk chunk;
  const std::uint64_t begin = from.u64_le();
  const std::uint64_t end = from.u64_le();
  chunk.uncompressed_bytes = from.u64_le();
  chunk.crc = from.u32_le();
  const std::uint32_t name_bytes = from.u32_le();
  if (name_bytes > kLongestCompressionName) return std::nullopt;
  const auto name = from.take(name_bytes);
  const std::optional<Compression> compression = compression_of({reinterpret_cast<const char*>(name.data()), name.size()});
  const std::uint64_t bytes = from.u64_le();
  if (!from.ok() || !compression || begin > end) return std::nullopt;
  chunk.compression = *compression;
  chunk.is_whole = bytes <= from.remaining();
  chunk.records = from.take(chunk.is_whole ? bytes : from.remaining());
  return chunk;
}

std::optional<McapAttachment> parse_attachment(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  from.skip(16);  // log and creation time
  McapAttachment attachment;
  attachment.name = text(from);
  attachment.media_type = text(from);
  attachment.bytes = from.take(from.u64_le());
  const std::size_t summed = from.position();
  const std::uint32_t crc = from.u32_le();
  if (!from.ok() || (crc != 0 && crc != crc32_of(content.first(summed)))) return std::nullopt;
  return attachment;
}

std::optional<McapMetadata> parse_metadata(std::span<const std::uint8_t> content) {
  ByteReader from{content};
  McapMetadata metadata;
  metadata.name = text(from);
  metadata.values = text_map(from);
  if (!from.ok()) return std::nullopt;
  return metadata;
}

std::optional<std::map<std::uint16_t, std::uint64_t>> parse_statistics(std::span<const std::uint8_t> content) {
  constexpr std::size_t kBeforeCounts = 8 + 2 + 4 * 4 + 2 * 8;
  ByteReader from{content};
  from.skip(kBeforeCounts);
  const auto bytes = from.take(from.u32_le());
  ByteReader entries{bytes};
  std::map<std::uint16_t, std::uint64_t> counts;
  while (entries.ok() && entries.remaining() > 0) {
    const std::uint16_t channel = entries.u16_le();
    counts[channel] = entries.u64_le();
  }
  if (!from.ok() || !entries.ok()) return std::nullopt;
  return counts;
}

}  // namespace slamd
