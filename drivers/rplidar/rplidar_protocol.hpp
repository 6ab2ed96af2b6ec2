#pragma once
// Requests to an RPLIDAR and the forms of its answers, as bytes. No state. Source: Slamtec, RPLIDAR interface protocol, v2.8.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamd {

enum class RplidarCommand : std::uint8_t {
  kScan = 0x20,
  kStop = 0x25,
  kReset = 0x40,
  kGetInfo = 0x50,
  kGetHealth = 0x52,
  kGetSampleRate = 0x59,
  kExpressScan = 0x82,  // these three have a payload
  kGetConfig = 0x84,
  kSetMotorPwm = 0xF0,
};

/// Data type byte of an answer.
enum class RplidarAnswer : std::uint8_t {
  kInfo = 0x04,
  kHealth = 0x06,
  kSampleRate = 0x15,
  kConfig = 0x20,
  kScan = 0x81,     // one sample of 5 bytes after the other
  kExpress = 0x82,  // capsules of 84 bytes, 32 samples
  kBoost = 0x84,    // capsules of 132 bytes, 96 samples
};

constexpr std::size_t kRplidarDescriptorBytes = 7;
constexpr std::size_t kRplidarNodeBytes = 5;
constexpr std::size_t kRplidarExpressBytes = 84;
constexpr std::size_t kRplidarBoostBytes = 132;
constexpr std::size_t kRplidarMostAnswer = 64;  // bytes of a single answer; the longest known is the info of 20

/// What comes after a descriptor.
struct RplidarDescriptor {
  RplidarAnswer answer;
  std::size_t size;  // of the answer, or of each packet of a stream
  bool is_stream;    // goes on until a stop
};
/// Nothing for bytes that no RPLIDAR sends as a descriptor: another begin, size or mode than the answer's own. Pure.
std::optional<RplidarDescriptor> parse_rplidar_descriptor(std::span<const std::uint8_t, kRplidarDescriptorBytes> bytes);

/// A request on its way out.
struct RplidarRequest {
  std::array<std::uint8_t, 16> bytes{};
  std::size_t size = 0;
  std::span<const std::uint8_t> view() const { return std::span{bytes}.first(size); }
};
/// payload  up to 12 bytes, of a command that has one; adds size and checksum
RplidarRequest rplidar_request(RplidarCommand command, std::span<const std::uint8_t> payload = {});
/// mode  as the sensor numbers its scan modes; 0 = the express scan that every firmware with one has
RplidarRequest rplidar_express_request(std::uint8_t mode);
/// duty  0..1023; 0 stops the motor
RplidarRequest rplidar_motor_request(std::uint16_t duty);

/// Entries of the configuration.
enum class RplidarConfigKey : std::uint32_t {
  kSamplePeriod = 0x71,  // of a mode: microseconds times 256
  kModeAnswer = 0x75,    // of a mode: type of its answer
  kTypicalMode = 0x7C,
};
/// mode  left out for entries that are of no mode
RplidarRequest rplidar_config_request(RplidarConfigKey key, std::optional<std::uint16_t> mode = std::nullopt);

struct RplidarInfo {
  std::uint8_t model = 0;
  std::uint8_t firmware_major = 0;
  std::uint8_t firmware_minor = 0;
  std::uint8_t hardware = 0;
  std::array<std::uint8_t, 16> serial{};
};
std::optional<RplidarInfo> parse_rplidar_info(std::span<const std::uint8_t> answer);

enum class RplidarHealth : std::uint8_t { kGood = 0, kWarning = 1, kError = 2 };
/// Nothing for an answer of another length or an unknown state.
std::optional<RplidarHealth> parse_rplidar_health(std::span<const std::uint8_t> answer);

/// From one sample to the next.
struct RplidarSampleRate {
  std::uint16_t standard_us = 0;
  std::uint16_t express_us = 0;
};
std::optional<RplidarSampleRate> parse_rplidar_sample_rate(std::span<const std::uint8_t> answer);

/// An entry of the configuration: which one, and its value as far as it is a number.
struct RplidarConfigValue {
  RplidarConfigKey key;
  std::uint32_t value;
};
std::optional<RplidarConfigValue> parse_rplidar_config(std::span<const std::uint8_t> answer);

}  // namespace slamd
