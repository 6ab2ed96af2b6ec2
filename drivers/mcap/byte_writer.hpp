#pragma once
// Appends little-endian integers and texts, as MCAP has them, to bytes. Knows no record.

#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "drivers/mcap/compression.hpp"
#include "drivers/mcap/mcap_format.hpp"

namespace slamd {

class ByteWriter {
 public:
  template <std::unsigned_integral T>
  ByteWriter& put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * i)));
    return *this;
  }
  ByteWriter& raw(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  ByteWriter& text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    return raw({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  /// Length in bytes in front.
  ByteWriter& block(const ByteWriter& content) {
    put(static_cast<std::uint32_t>(content.bytes_.size()));
    return raw(content.bytes_);
  }
  template <class Map>
  ByteWriter& text_map(const Map& map) {
    ByteWriter entries;
    for (const auto& [key, value] : map) entries.text(key).text(value);
    return block(entries);
  }

  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// A whole record: opcode, length, content.
inline Bytes mcap_record(McapOp op, const ByteWriter& content) {
  ByteWriter record;
  record.put(static_cast<std::uint8_t>(op)).put(std::uint64_t{content.bytes().size()}).raw(content.bytes());
  return record.bytes();
}

}  // namespace slamd
