#pragma once
// The IMU frame on the wire: its fields, encoder and decoder of one packet. Freestanding (firmware and PC); finding
// packets in a byte stream is drivers/imu, SI units and host time as well.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/protocol/cobs.hpp"
#include "firmware/protocol/crc16.hpp"
#include "firmware/protocol/wire.hpp"

namespace slamd {

constexpr std::uint8_t kImuFrameKindVersion = 0x11;  // high nibble: kind 1 = sample; low nibble: version 1
constexpr std::size_t kImuFramePlainBytes = 30;
constexpr std::size_t kImuFramePacketBytes = cobs_max_encoded(kImuFramePlainBytes);  // without the delimiter
constexpr std::size_t kImuFrameWireBytes = kImuFramePacketBytes + 1;                 // with the delimiter
constexpr std::uint8_t kImuFrameDelimiter = 0x00;
static_assert(kImuFrameWireBytes == 32);

/// LSM6DSOX data sheet, table 3: accelerometer +-4 g, gyroscope +-500 dps, temperature.
constexpr double kImuAccelMgPerLsb = 0.122;
constexpr double kImuGyroMdpsPerLsb = 17.50;
constexpr double kImuTemperatureLsbPerC = 256.0;
constexpr double kImuTemperatureZeroC = 25.0;

/// Bits of ImuFrame::status. Numbers are never reused.
enum class ImuStatus : std::uint8_t {
  kOverrun = 1U << 0U,        // the sensor had a newer sample before this one was read: samples are missing
  kGyroClipped = 1U << 1U,    // an axis at the end of its range
  kAccelClipped = 1U << 2U,   // likewise
  kSensorFault = 1U << 3U,    // the sensor does not answer as it should; gyro and accel are not valid
  kWatchdogReset = 1U << 4U,  // the last start of the device was the watchdog's
  kFirstFrame = 1U << 5U,     // first frame after a start of the device: its clock and sequence are new
};

struct ImuFrame {
  std::uint8_t status = 0;             // bits of ImuStatus
  std::uint16_t sequence = 0;          // counts every sample, sent or dropped; wraps
  std::uint64_t device_us = 0;         // device clock at data-ready
  std::array<std::int16_t, 3> gyro{};  // LSB, sensor axes x y z
  std::array<std::int16_t, 3> accel{};
  std::int16_t temperature = 0;  // 256 LSB/degC, 0 = 25 degC
  std::uint16_t dropped = 0;     // frames that could not be sent since start; wraps

  constexpr bool has(ImuStatus bit) const { return (status & static_cast<std::uint8_t>(bit)) != 0; }
  friend constexpr bool operator==(const ImuFrame&, const ImuFrame&) = default;
};

enum class ImuFrameError : std::uint8_t { kNone, kLength, kCobs, kCrc, kVersion };

struct DecodedImuFrame {
  ImuFrameError error = ImuFrameError::kNone;
  ImuFrame frame;  // meaningful when error is kNone

  constexpr explicit operator bool() const { return error == ImuFrameError::kNone; }
};

/// The fields after the kind byte with their offsets; wire is a Writer or a Reader.
constexpr void imu_frame_fields(const auto& wire, auto& frame) {
  wire(1, frame.status);
  wire(2, frame.sequence);
  wire(4, frame.device_us);
  wire(12, frame.gyro);
  wire(18, frame.accel);
  wire(24, frame.temperature);
  wire(26, frame.dropped);
}

/// The 30 plain bytes of a frame, CRC included, before COBS.
constexpr std::array<std::uint8_t, kImuFramePlainBytes> pack(const ImuFrame& frame) {
  std::array<std::uint8_t, kImuFramePlainBytes> plain{};
  plain[0] = kImuFrameKindVersion;
  imu_frame_fields(wire::Writer{plain}, frame);
  wire::store(plain, 28, crc16(std::span<const std::uint8_t>{plain}.first(28)));
  return plain;
}

/// The bytes for the wire: always kImuFrameWireBytes, the last one is the delimiter. O(1), no state.
constexpr std::array<std::uint8_t, kImuFrameWireBytes> encode(const ImuFrame& frame) {
  const std::array<std::uint8_t, kImuFramePlainBytes> plain = pack(frame);
  std::array<std::uint8_t, kImuFrameWireBytes> bytes{};
  cobs_encode(plain, bytes);
  return bytes;
}

/// Decodes what stood between two delimiters. Anything that is not exactly one frame of this version with a right CRC
/// comes back with the error that was found first.
constexpr DecodedImuFrame decode_imu_packet(std::span<const std::uint8_t> packet) {
  if (packet.size() != kImuFramePacketBytes) return {ImuFrameError::kLength, {}};
  std::array<std::uint8_t, kImuFramePlainBytes> plain{};
  if (cobs_decode(packet, plain) != plain.size()) return {ImuFrameError::kCobs, {}};
  const std::span<const std::uint8_t> bytes{plain};
  if (wire::load<std::uint16_t>(bytes, 28) != crc16(bytes.first(28))) return {ImuFrameError::kCrc, {}};
  if (plain[0] != kImuFrameKindVersion) return {ImuFrameError::kVersion, {}};

  ImuFrame frame;
  imu_frame_fields(wire::Reader{bytes}, frame);
  return {ImuFrameError::kNone, frame};
}

}  // namespace slamd
