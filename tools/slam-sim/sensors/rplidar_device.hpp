#pragma once
// The firmware of an RPLIDAR A2 behind its serial port: takes commands, gives answers, knows whether it scans. The measurements are
// rplidar_sensor's.

#include <cstdint>
#include <span>
#include <vector>

#include "tools/slam-sim/sensors/rplidar_sensor.hpp"

namespace slamd::sim {

class RplidarDevice {
 public:
  explicit RplidarDevice(RplidarFirmware firmware) : firmware_{firmware} {}

  /// Bytes from the host, any split; what it answers. Commands that its firmware does not know get no answer.
  std::vector<std::uint8_t> take(std::span<const std::uint8_t> bytes);
  /// Whether measurements go out: asked to scan, and the motor turns.
  bool is_scanning() const { return scanning_; }

 private:
  bool is_whole() const;
  std::vector<std::uint8_t> answer();
  std::vector<std::uint8_t> config() const;

  RplidarFirmware firmware_;
  std::vector<std::uint8_t> command_;  // as far as it has come
  bool scanning_ = false;
};

/// What a host has asked and got before a recording begins: identity, health, mode, and the begin of the stream.
std::vector<std::uint8_t> rplidar_greeting(RplidarFirmware firmware);

}  // namespace slamd::sim
