#pragma once
// What the IMU board says besides samples: identity, statistics, self-test, acknowledgement. Fields and
// layouts. Replies carry the command's tag; statistics also come unasked (tag 0) when the sensor's state or fault
// changes. Freestanding.

#include <array>
#include <cstddef>
#include <cstdint>

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

template <>
struct Layout<Identity> {
  static constexpr PacketKind kKind = PacketKind::kIdentity;
  static constexpr std::size_t kPlainBytes = 24;

  static constexpr void fields(const auto& wire, auto& packet) {
    wire(1, packet.sensor_id);
    wire(2, packet.tag);
    wire(4, packet.unique_id);
    wire(12, packet.version);
    wire(15, packet.chip_revision);
    wire(16, packet.rate_hz);
    wire(18, packet.gyro_range_dps);
    wire(20, packet.accel_range_g);
  }
};

template <>
struct Layout<Statistics> {
  static constexpr PacketKind kKind = PacketKind::kStatistics;
  static constexpr std::size_t kPlainBytes = 48;

  static constexpr void fields(const auto& wire, auto& packet) {
    wire(1, packet.sensor_state);
    wire(2, packet.tag);
    wire(4, packet.device_us);
    wire(12, packet.samples);
    wire(16, packet.dropped);
    wire(20, packet.overruns);
    wire(24, packet.faults);
    wire(28, packet.fault);
    wire(29, packet.reset_cause);
    wire(30, packet.restarts);
    wire(32, packet.bus_recoveries);
    wire(34, packet.usb_resets);
    wire(36, packet.usb_suspends);
    wire(38, packet.bad_commands);
    wire(40, packet.latency_max_us);
    wire(42, packet.loop_max_us);
    wire(44, packet.queue_max_bytes);
  }
};

template <>
struct Layout<SelfTestReport> {
  static constexpr PacketKind kKind = PacketKind::kSelfTest;
  static constexpr std::size_t kPlainBytes = 20;

  static constexpr void fields(const auto& wire, auto& packet) {
    wire(1, packet.outcome);
    wire(2, packet.tag);
    wire(4, packet.accel_mg);
    wire(10, packet.gyro_ddps);
    wire(16, packet.failed_axes);
  }
};

template <>
struct Layout<Acknowledgement> {
  static constexpr PacketKind kKind = PacketKind::kAcknowledgement;
  static constexpr std::size_t kPlainBytes = 8;

  static constexpr void fields(const auto& wire, auto& packet) {
    wire(1, packet.code);
    wire(2, packet.tag);
    wire(4, packet.result);
  }
};

}  // namespace slamd
