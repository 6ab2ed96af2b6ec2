#pragma once
// The records of the MCAP container by its published specification (mcap.dev/spec), as values. Neither reads nor writes files.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace slamd {

inline constexpr std::array<std::uint8_t, 8> kMcapMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};
inline constexpr std::size_t kMcapRecordHead = 9;  // opcode and length before each record's content

struct McapSchema {
  std::uint16_t id = 0;  // never 0
  std::string name, encoding, text;
};

struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  // 0: none
  std::string topic, encoding;
  std::map<std::string, std::string> metadata{};
};

struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0, publish_time_ns = 0;
  std::span<const std::uint8_t> bytes;
};

}  // namespace slamd
