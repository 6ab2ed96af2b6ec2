#pragma once
// The compressions of recorded chunks: zstd and lz4 frames, bzip2. Whole blocks in memory; no streams, no files.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace slamd {

using Bytes = std::vector<std::uint8_t>;

enum class Compression : std::uint8_t { kNone, kLz4, kZstd, kBzip2 };

/// Nothing for a name that no format uses. none and the empty name are kNone.
std::optional<Compression> compression_of(std::string_view name);

struct Decompressed {
  Bytes bytes;
  bool whole = false;  // false: the input broke off or is damaged, and `bytes` is what came before that
};

/// bytes      may be cut off or damaged
/// most_bytes that come out; beyond it the result is not whole. Memory of that size is never taken before there is so much.
Decompressed decompress(Compression compression, std::span<const std::uint8_t> bytes, std::size_t most_bytes);

/// One frame at zstd's fastest standard level.
Bytes compress_zstd(std::span<const std::uint8_t> bytes);

/// CRC-32 as of zlib. `before` continues an earlier one.
std::uint32_t crc32_of(std::span<const std::uint8_t> bytes, std::uint32_t before = 0);

}  // namespace slamd
