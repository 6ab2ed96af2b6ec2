#pragma once
// Reads UF2 files (512-byte blocks, github.com/microsoft/uf2) for the RP2040's flash. It trusts nothing in them and
// touches no device.

#include <cstdint>
#include <span>

#include "tools/imu-flash/flash_image.hpp"

namespace slamd::flash {

constexpr std::size_t kUf2BlockBytes = 512;
constexpr std::uint32_t kUf2FamilyRp2040 = 0xE48B'FF56;

/// The image of a whole UF2 file, or why not: length, magic numbers, family, payload size, address range and alignment,
/// block numbers (each of 0 .. count-1 once, count as in every block), no page twice. Blocks that say of themselves
/// that they are not for the main flash are skipped.
LoadedImage parse_uf2(std::span<const std::uint8_t> file);

}  // namespace slamd::flash
