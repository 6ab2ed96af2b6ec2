#pragma once
// What the IMU board says besides samples: identity, statistics, self-test, acknowledgement. Layouts, encoders,
// decoders. Replies carry the command's tag; statistics also come unasked (tag 0) when the sensor's state or fault
// changes. Freestanding.

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/protocol/packet.hpp"

namespace slamd {

struct Identity {
  std::uint8_t sensor_id = 0;  // the sensor's WHO_AM_I as last read, 0x6C = LSM6DSOX; 0 = it never answered
  std::uint16_t tag = 0;
  std::array<std::uint8_t, 8> unique_id{};  // of the flash chip; as hex digits it is the USB serial number
  std::array<std::uint8_t, 3> version{};    // of the firmware: major, minor, patch
  std::uint8_t chip_revision = 0;           // RP2040: 1 = B0 or B1, 2 = B2
  std::uint16_t rate_hz = 0;                // nominal output data rate
  std::uint16_t gyro_range_dps = 0;
  std::uint8_t accel_range_g = 0;

  friend constexpr bool operator==(const Identity&, const Identity&) = default;
};

/// Numbers are never reused.
enum class SensorState : std::uint8_t { kStarting = 0, kRunning = 1, kSelfTest = 2, kFault = 3 };
enum class SensorFault : std::uint8_t {
  kNone = 0,
  kNoAnswer = 1,       // nobody acknowledges the sensor's address
  kWrongId = 2,        // WHO_AM_I is not the LSM6DSOX's
  kBusHung = 3,        // a transfer did not end, or a line is held low
  kConfiguration = 4,  // registers do not read back as written
  kNoData = 5,         // data-ready stopped
};
enum class ResetCause : std::uint8_t { kPower = 0, kWatchdog = 1, kRequest = 2 };

/// Counters since the start of the device; those of 16 bits stop at 65535, those of 32 bits wrap.
struct Statistics {
  SensorState sensor_state = SensorState::kStarting;
  SensorFault fault = SensorFault::kNone;  // the last one, also when it is over
  ResetCause reset_cause = ResetCause::kPower;
  std::uint16_t tag = 0;
  std::uint64_t device_us = 0;
  std::uint32_t samples = 0;   // taken, sent or dropped
  std::uint32_t dropped = 0;   // frames that found no room
  std::uint32_t overruns = 0;  // samples that the sensor replaced before they were read
  std::uint32_t faults = 0;    // times the sensor was lost
  std::uint16_t restarts = 0;  // attempts to initialise the sensor anew
  std::uint16_t bus_recoveries = 0;
  std::uint16_t usb_resets = 0;
  std::uint16_t usb_suspends = 0;
  std::uint16_t bad_commands = 0;
  std::uint16_t latency_max_us = 0;   // data-ready to frame queued
  std::uint16_t loop_max_us = 0;      // longest pass of the main loop
  std::uint16_t queue_max_bytes = 0;  // high water of the bytes waiting for the host

  friend constexpr bool operator==(const Statistics&, const Statistics&) = default;
};

enum class SelfTestOutcome : std::uint8_t { kPassed = 0, kFailed = 1, kNotRun = 2 };

/// The sensor's built-in self-test: change of output under its electrostatic force. Limits are the data sheet's:
/// 50..1700 mg, 150..700 dps.
struct SelfTestReport {
  SelfTestOutcome outcome = SelfTestOutcome::kNotRun;  // kNotRun: the sensor was lost, nothing is measured
  std::uint8_t failed_axes = 0;                        // bits 0..2 accelerometer x y z, 3..5 gyroscope
  std::uint16_t tag = 0;
  std::array<std::int16_t, 3> accel_mg{};
  std::array<std::int16_t, 3> gyro_ddps{};  // tenths of a degree per second

  friend constexpr bool operator==(const SelfTestReport&, const SelfTestReport&) = default;
};

enum class CommandResult : std::uint8_t { kAccepted = 0, kUnknown = 1, kBusy = 2 };

struct Acknowledgement {
  std::uint8_t code = 0;  // of the command
  std::uint16_t tag = 0;
  CommandResult result = CommandResult::kAccepted;

  friend constexpr bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

constexpr std::size_t kIdentityPlainBytes = 24;
constexpr std::size_t kStatisticsPlainBytes = 48;
constexpr std::size_t kSelfTestPlainBytes = 20;
constexpr std::size_t kAcknowledgementPlainBytes = 8;

constexpr std::array<std::uint8_t, kIdentityPlainBytes + 2> encode(const Identity& identity) {
  std::array<std::uint8_t, kIdentityPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(PacketKind::kIdentity);
  plain[1] = identity.sensor_id;
  wire::store(plain, 2, identity.tag);
  for (std::size_t i = 0; i < 8; ++i) plain[4 + i] = identity.unique_id[i];
  for (std::size_t i = 0; i < 3; ++i) plain[12 + i] = identity.version[i];
  plain[15] = identity.chip_revision;
  wire::store(plain, 16, identity.rate_hz);
  wire::store(plain, 18, identity.gyro_range_dps);
  plain[20] = identity.accel_range_g;
  return seal_packet(plain);
}

constexpr std::optional<Identity> read_identity(const OpenedPacket& packet) {
  if (!packet.is(PacketKind::kIdentity, kIdentityPlainBytes)) return std::nullopt;
  Identity identity;
  identity.sensor_id = packet.plain[1];
  identity.tag = wire::load<std::uint16_t>(packet.plain, 2);
  for (std::size_t i = 0; i < 8; ++i) identity.unique_id[i] = packet.plain[4 + i];
  for (std::size_t i = 0; i < 3; ++i) identity.version[i] = packet.plain[12 + i];
  identity.chip_revision = packet.plain[15];
  identity.rate_hz = wire::load<std::uint16_t>(packet.plain, 16);
  identity.gyro_range_dps = wire::load<std::uint16_t>(packet.plain, 18);
  identity.accel_range_g = packet.plain[20];
  return identity;
}

constexpr std::array<std::uint8_t, kStatisticsPlainBytes + 2> encode(const Statistics& statistics) {
  std::array<std::uint8_t, kStatisticsPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(PacketKind::kStatistics);
  plain[1] = static_cast<std::uint8_t>(statistics.sensor_state);
  wire::store(plain, 2, statistics.tag);
  wire::store(plain, 4, statistics.device_us);
  wire::store(plain, 12, statistics.samples);
  wire::store(plain, 16, statistics.dropped);
  wire::store(plain, 20, statistics.overruns);
  wire::store(plain, 24, statistics.faults);
  plain[28] = static_cast<std::uint8_t>(statistics.fault);
  plain[29] = static_cast<std::uint8_t>(statistics.reset_cause);
  wire::store(plain, 30, statistics.restarts);
  wire::store(plain, 32, statistics.bus_recoveries);
  wire::store(plain, 34, statistics.usb_resets);
  wire::store(plain, 36, statistics.usb_suspends);
  wire::store(plain, 38, statistics.bad_commands);
  wire::store(plain, 40, statistics.latency_max_us);
  wire::store(plain, 42, statistics.loop_max_us);
  wire::store(plain, 44, statistics.queue_max_bytes);
  return seal_packet(plain);
}

constexpr std::optional<Statistics> read_statistics(const OpenedPacket& packet) {
  if (!packet.is(PacketKind::kStatistics, kStatisticsPlainBytes)) return std::nullopt;
  const auto& plain = packet.plain;
  Statistics statistics;
  statistics.sensor_state = static_cast<SensorState>(plain[1]);
  statistics.tag = wire::load<std::uint16_t>(plain, 2);
  statistics.device_us = wire::load<std::uint64_t>(plain, 4);
  statistics.samples = wire::load<std::uint32_t>(plain, 12);
  statistics.dropped = wire::load<std::uint32_t>(plain, 16);
  statistics.overruns = wire::load<std::uint32_t>(plain, 20);
  statistics.faults = wire::load<std::uint32_t>(plain, 24);
  statistics.fault = static_cast<SensorFault>(plain[28]);
  statistics.reset_cause = static_cast<ResetCause>(plain[29]);
  statistics.restarts = wire::load<std::uint16_t>(plain, 30);
  statistics.bus_recoveries = wire::load<std::uint16_t>(plain, 32);
  statistics.usb_resets = wire::load<std::uint16_t>(plain, 34);
  statistics.usb_suspends = wire::load<std::uint16_t>(plain, 36);
  statistics.bad_commands = wire::load<std::uint16_t>(plain, 38);
  statistics.latency_max_us = wire::load<std::uint16_t>(plain, 40);
  statistics.loop_max_us = wire::load<std::uint16_t>(plain, 42);
  statistics.queue_max_bytes = wire::load<std::uint16_t>(plain, 44);
  return statistics;
}

constexpr std::array<std::uint8_t, kSelfTestPlainBytes + 2> encode(const SelfTestReport& report) {
  std::array<std::uint8_t, kSelfTestPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(PacketKind::kSelfTest);
  plain[1] = static_cast<std::uint8_t>(report.outcome);
  wire::store(plain, 2, report.tag);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    wire::store(plain, 4 + 2 * axis, static_cast<std::uint16_t>(report.accel_mg[axis]));
    wire::store(plain, 10 + 2 * axis, static_cast<std::uint16_t>(report.gyro_ddps[axis]));
  }
  plain[16] = report.failed_axes;
  return seal_packet(plain);
}

constexpr std::optional<SelfTestReport> read_self_test(const OpenedPacket& packet) {
  if (!packet.is(PacketKind::kSelfTest, kSelfTestPlainBytes)) return std::nullopt;
  SelfTestReport report;
  report.outcome = static_cast<SelfTestOutcome>(packet.plain[1]);
  report.tag = wire::load<std::uint16_t>(packet.plain, 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    report.accel_mg[axis] = static_cast<std::int16_t>(wire::load<std::uint16_t>(packet.plain, 4 + 2 * axis));
    report.gyro_ddps[axis] = static_cast<std::int16_t>(wire::load<std::uint16_t>(packet.plain, 10 + 2 * axis));
  }
  report.failed_axes = packet.plain[16];
  return report;
}

constexpr std::array<std::uint8_t, kAcknowledgementPlainBytes + 2> encode(const Acknowledgement& acknowledgement) {
  std::array<std::uint8_t, kAcknowledgementPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(PacketKind::kAcknowledgement);
  plain[1] = acknowledgement.code;
  wire::store(plain, 2, acknowledgement.tag);
  plain[4] = static_cast<std::uint8_t>(acknowledgement.result);
  return seal_packet(plain);
}

constexpr std::optional<Acknowledgement> read_acknowledgement(const OpenedPacket& packet) {
  if (!packet.is(PacketKind::kAcknowledgement, kAcknowledgementPlainBytes)) return std::nullopt;
  return Acknowledgement{packet.plain[1], wire::load<std::uint16_t>(packet.plain, 2),
                         static_cast<CommandResult>(packet.plain[4])};
}

}  // namespace slamd
