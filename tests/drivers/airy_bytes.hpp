#pragma once
// Packets of a RoboSense Airy, written field by field from the tables of its manual.

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace slamd::test {

using Bytes = std::vector<std::uint8_t>;

inline void store_be(Bytes& bytes, std::size_t at, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (count - 1 - i)));
}

/// A data packet of one return: stamp seconds and microseconds, first column's azimuth and step, nothing returned.
inline Bytes airy_packet(std::uint64_t s, std::uint32_t us, int azimuth_cdeg, int step_cdeg = 40, bool dual = false) {
  Bytes bytes(1248);
  store_be(bytes, 0, 0x55AA055A, 4);
  bytes[17] = dual ? 3 : 0;
  store_be(bytes, 20, s, 6);
  store_be(bytes, 26, us, 4);
  bytes[32] = 2;
  for (std::size_t block = 0; block < 8; ++block) {
    const int column = static_cast<int>(dual ? block / 4 : block / 2);
    store_be(bytes, 42 + block * 148, 0xFFEE, 2);
    store_be(bytes, 44 + block * 148, static_cast<std::uint64_t>((azimuth_cdeg + column * step_cdeg) % 36000), 2);
  }
  return bytes;
}

/// Puts an echo into a block's channel 0..47: distance in counts of 5 mm.
inline void put_echo(Bytes& packet, std::size_t block, std::size_t channel, unsigned counts, std::uint8_t intensity) {
  store_be(packet, 46 + block * 148 + channel * 3, counts, 2);
  packet[48 + block * 148 + channel * 3] = intensity;
}

/// A device packet: channel i looks up by i times 90 hundredths of a degree, and none aside.
inline Bytes airy_device_packet() {
  Bytes bytes(1248);
  store_be(bytes, 0, 0xA5FF005A11115555, 8);
  store_be(bytes, 8, 600, 2);
  bytes[300] = 0;
  for (std::size_t i = 0; i < 96; ++i) store_be(bytes, 468 + 3 * i + 1, 90 * i, 2);
  store_be(bytes, 1092 + 12, std::bit_cast<std::uint32_t>(1.0F), 4);  // the IMU's quaternion: w
  store_be(bytes, 1246, 0x0FF0, 2);
  return bytes;
}

/// An IMU packet of 4 g and 500 degrees a second.
inline Bytes airy_imu_packet(std::uint64_t s, std::uint32_t us, const std::array<std::int32_t, 6>& accel_gyro) {
  Bytes bytes(51);
  store_be(bytes, 0, 0xAA555A05, 4);
  store_be(bytes, 4, s, 6);
  store_be(bytes, 10, us, 4);
  for (std::size_t i = 0; i < 6; ++i) store_be(bytes, 14 + 4 * i, static_cast<std::uint32_t>(accel_gyro[i]), 4);
  bytes[43] = 1;
  bytes[44] = 1;
  return bytes;
}

}  // namespace slamd::test
