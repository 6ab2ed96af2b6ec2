#include "tools/slam-sim/sensors/rplidar_device.hpp"

namespace slamd::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kBegin = 0xA5, kHasPayload = 0x80;
constexpr std::uint8_t kScan = 0x20, kForceScan = 0x21, kStop = 0x25, kReset = 0x40, kInfo = 0x50, kHealth = 0x52, kRate = 0x59,
                       kExpress = 0x82, kConfig = 0x84, kMotor = 0xF0;
constexpr std::uint8_t kBoostMode = 2;

/// Descriptor and, of a single answer, what follows it.
Bytes told(std::uint8_t type, std::uint8_t size, bool stream, const Bytes& body = {}) {
  Bytes bytes{kBegin, 0x5A, size, 0, 0, static_cast<std::uint8_t>(stream ? 0x40 : 0), type};
  for (const std::uint8_t byte : body) bytes.push_back(byte);
  return bytes;
}

Bytes little(std::uint32_t value, int count) {
  Bytes bytes;
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  return bytes;
}

Bytes stream_of(std::uint8_t command, std::uint8_t mode) {
  if (command != kExpress) return told(0x81, 5, true);
  return mode == kBoostMode ? told(0x84, 132, true) : told(0x82, 84, true);
}

}  // namespace

bool RplidarDevice::is_whole() const {
  if (command_.size() < 2) return false;
  if ((command_[1] & kHasPayload) == 0) return true;
  return command_.size() >= 3 && command_.size() == 4U + command_[2];
}

Bytes RplidarDevice::take(std::span<const std::uint8_t> bytes) {
  Bytes out;
  for (const std::uint8_t byte : bytes) {
    if (command_.empty() && byte != kBegin) continue;
    command_.push_back(byte);
    if (!is_whole()) continue;
    for (const std::uint8_t told_byte : answer()) out.push_back(told_byte);
    command_.clear();
  }
  return out;
}

/// A command with a wrong checksum is none.
Bytes RplidarDevice::answer() {
  const std::uint8_t command = command_[1];
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : command_) sum ^= byte;
  const bool has_payload = (command & kHasPayload) != 0;
  if (has_payload && sum != 0) return {};
  const bool is_old = firmware_ == RplidarFirmware::kStandard;
  switch (command) {
    case kStop:
    case kReset: scanning_ = false; return {};
    case kMotor: return {};
    case kInfo: {
      Bytes body{0x28, static_cast<std::uint8_t>(firmware_ == RplidarFirmware::kBoost ? 25 : is_old ? 10 : 18), 1, 5};
      for (std::uint8_t i = 0; i < 16; ++i) body.push_back(static_cast<std::uint8_t>(0xA0 + i));
      return told(0x04, 20, false, body);
    }
    case kHealth: return told(0x06, 3, false, {0, 0, 0});
    case kRate: return told(0x15, 4, false, {0xF4, 0x01, 0xFA, 0x00});
    case kConfig: return config();
    case kScan:
    case kForceScan:
    case kExpress: break;
    default: return {};
  }
  // This unit's measurements have one form: it scans in the mode that its firmware is best at, and in no other.
  const std::uint8_t mode = has_payload ? command_[3] : std::uint8_t{0};
  const bool fits = command == kExpress ? (firmware_ == RplidarFirmware::kBoost ? mode == kBoostMode : !is_old && mode == 0) : is_old;
  if (fits) scanning_ = true;
  return fits ? stream_of(command, mode) : Bytes{};
}

/// Only of firmware since 1.24: the typical mode, the type of its answer, and microseconds a sample times 256.
Bytes RplidarDevice::config() const {
  if (firmware_ != RplidarFirmware::kBoost || command_.size() < 8) return {};
  const std::uint8_t key = command_[3];
  Bytes body = little(key, 4);
  Bytes value;
  if (key == 0x7C) value = little(kBoostMode, 2);
  if (key == 0x75) value = little(0x84, 1);
  if (key == 0x71) value = little(static_cast<std::uint32_t>(format_of(firmware_).period_us) * 256U, 4);
  if (value.empty()) return {};
  for (const std::uint8_t byte : value) body.push_back(byte);
  return told(0x20, static_cast<std::uint8_t>(body.size()), false, body);
}

Bytes rplidar_greeting(RplidarFirmware firmware) {
  RplidarDevice device{firmware};
  const Bytes asked{kBegin, kInfo, kBegin, kHealth, kBegin, kRate, kBegin, kConfig, 6, 0x71, 0, 0, 0, 2, 0, 0x54, kBegin, kScan,
                    kBegin, kExpress, 5, 0, 0, 0, 0, 0, 0x22, kBegin, kExpress, 5, kBoostMode, 0, 0, 0, 0, 0x20};
  return device.take(asked);
}

}  // namespace slamd::sim
