#pragma once
// Builds VLP-16 data packets byte by byte for tests, from the manual's table and not from the decoder's code.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd {

struct Vlp16Bytes {
  std::array<std::uint8_t, 1206> bytes{};

  /// Every block flagged, azimuths from `azimuth` on in steps of `step` (dual return: pairs share one), no returns.
  Vlp16Bytes(int azimuth, int step, std::uint32_t stamp_us, std::uint8_t mode = 0x37) {
    for (std::size_t block = 0; block < 12; ++block) {
      put16(block * 100, 0xEEFF);
      const int index = static_cast<int>(mode == 0x39 ? block / 2 : block);
      set_azimuth(block, static_cast<std::uint16_t>((azimuth + index * step) % 36000));
    }
    set_stamp(stamp_us);
    bytes[1204] = mode;
    bytes[1205] = 0x22;
  }

  void set_azimuth(std::size_t block, std::uint16_t azimuth) { put16(block * 100 + 2, azimuth); }
  void set_stamp(std::uint32_t us) {
    put16(1200, static_cast<std::uint16_t>(us));
    put16(1202, static_cast<std::uint16_t>(us >> 16U));
  }
  /// channel 0..31, distance in 2 mm
  void set_return(std::size_t block, std::size_t channel, std::uint16_t distance, std::uint8_t intensity) {
    put16(block * 100 + 4 + channel * 3, distance);
    bytes[block * 100 + 4 + channel * 3 + 2] = intensity;
  }
  void fill_returns(std::uint16_t distance) {
    for (std::size_t block = 0; block < 12; ++block) {
      for (std::size_t channel = 0; channel < 32; ++channel) set_return(block, channel, distance, 100);
    }
  }
  std::span<const std::uint8_t> span() const { return bytes; }

 private:
  void put16(std::size_t at, std::uint16_t value) {
    bytes[at] = static_cast<std::uint8_t>(value);
    bytes[at + 1] = static_cast<std::uint8_t>(value >> 8U);
  }
};

}  // namespace slamd
