#pragma once
// Parses the content of single MCAP records. It does not walk files (mcap_reader.hpp).

#include <optional>

#include "drivers/io/byte_reader.hpp"
#include "drivers/mcap/compression.hpp"
#include "drivers/mcap/mcap_format.hpp"

namespace slamd {

/// A chunk's head and its compressed records, borrowed.
struct McapChunk {
  std::uint64_t uncompressed_bytes = 0;
  std::uint32_t crc = 0;  // of the records as they were before compression; 0: not given
  Compression compression = Compression::kNone;
  std::span<const std::uint8_t> records;
  bool is_whole = true;  // false: fewer records are here than its head says
};

struct McapAttachment {
  std::string name, media_type;
  std::span<const std::uint8_t> bytes;
};

// Each gives nothing for content that is no such record.
std::optional<McapSchema> parse_schema(std::span<const std::uint8_t> content);
std::optional<McapChannel> parse_channel(std::span<const std::uint8_t> content);
std::optional<McapMessage> parse_message(std::span<const std::uint8_t> content);
/// `content` may end too early within the records.
std::optional<McapChunk> parse_chunk(std::span<const std::uint8_t> content);
/// Also refused when its checksum is wrong.
std::optional<McapAttachment> parse_attachment(std::span<const std::uint8_t> content);
struct McapMetadata {
  std::string name;
  std::map<std::string, std::string> values;
};
std::optional<McapMetadata> parse_metadata(std::span<const std::uint8_t> content);
/// Messages by channel.
std::optional<std::map<std::uint16_t, std::uint64_t>> parse_statistics(std::span<const std::uint8_t> content);

}  // namespace slamd
