#pragma once
// Decompression of LZF, the coding inside of binary_compressed PCD files. Does not compress.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace slamd::plot {

/// The plain bytes, or none when the input is damaged or does not give exactly `size` bytes. Cost linear in `size`.
/// Format: a byte c < 32 announces c + 1 bytes as they are; else a copy of (c >> 5) + 2 bytes (7: plus the next byte) from
/// ((c & 31) << 8) + next byte + 1 bytes back, which may overlap what it writes.
std::optional<std::string> lzf_decompress(std::string_view packed, std::size_t size);

}  // namespace slamd::plot
