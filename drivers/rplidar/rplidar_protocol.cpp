#include "drivers/rplidar/rplidar_protocol.hpp"

#include <algorithm>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr std::uint8_t kRequestBegin = 0xA5;
constexpr std::uint16_t kDescriptorBegin = 0xA55A;
constexpr std::uint32_t kSizeBits = (1U << 30U) - 1;
constexpr std::uint32_t kStreamMode = 1;

struct Form {
  RplidarAnswer answer;
  std::size_t size;  // 0: any up to the longest
  bool is_stream;
};
constexpr std::array<Form, 7> kForms = {{{RplidarAnswer::kInfo, 20, false},
                                         {RplidarAnswer::kHealth, 3, false},
                                         {RplidarAnswer::kSampleRate, 4, false},
                                         {RplidarAnswer::kConfig, 0, false},
                                         {RplidarAnswer::kScan, kRplidarNodeBytes, true},
                                         {RplidarAnswer::kExpress, kRplidarExpressBytes, true},
                                         {RplidarAnswer::kBoost, kRplidarBoostBytes, true}}};

bool fits(const Form& form, std::uint8_t type, std::size_t size, bool is_stream) {
  const bool size_fits = form.size == 0 ? size >= 4 && size <= kRplidarMostAnswer : size == form.size;
  return static_cast<std::uint8_t>(form.answer) == type && size_fits && form.is_stream == is_stream;
}

}  // namespace

std::optional<RplidarDescriptor> parse_rplidar_descriptor(std::span<const std::uint8_t, kRplidarDescriptorBytes> bytes) {
  ByteReader reader{bytes};
  if (reader.u16_be() != kDescriptorBegin) return std::nullopt;
  const std::uint32_t word = reader.u32_le();
  const std::uint8_t type = reader.u8();
  const std::size_t size = word & kSizeBits;
  if (word >> 30U > kStreamMode) return std::nullopt;
  const bool is_stream = word >> 30U == kStreamMode;
  for (const Form& form : kForms) {
    if (fits(form, type, size, is_stream)) return RplidarDescriptor{form.answer, size, is_stream};
  }
  return std::nullopt;
}

RplidarRequest rplidar_request(RplidarCommand command, std::span<const std::uint8_t> payload) {
  RplidarRequest request;
  request.bytes[0] = kRequestBegin;
  request.bytes[1] = static_cast<std::uint8_t>(command);
  request.size = 2;
  if (payload.empty()) return request;
  request.bytes[request.size++] = static_cast<std::uint8_t>(payload.size());
  for (const std::uint8_t byte : payload) request.bytes[request.size++] = byte;
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : request.view()) sum ^= byte;
  request.bytes[request.size++] = sum;
  return request;
}

RplidarRequest rplidar_express_request(std::uint8_t mode) {
  const std::array<std::uint8_t, 5> payload{mode};
  return rplidar_request(RplidarCommand::kExpressScan, payload);
}

RplidarRequest rplidar_motor_request(std::uint16_t duty) {
  const std::array payload{static_cast<std::uint8_t>(duty), static_cast<std::uint8_t>(duty >> 8U)};
  return rplidar_request(RplidarCommand::kSetMotorPwm, payload);
}

RplidarRequest rplidar_config_request(RplidarConfigKey key, std::optional<std::uint16_t> mode) {
  const auto k = static_cast<std::uint32_t>(key);
  const std::uint16_t m = mode.value_or(0);
  const std::array payload{static_cast<std::uint8_t>(k),        static_cast<std::uint8_t>(k >> 8U),
                           static_cast<std::uint8_t>(k >> 16U), static_cast<std::uint8_t>(k >> 24U),
                           static_cast<std::uint8_t>(m),        static_cast<std::uint8_t>(m >> 8U)};
  return rplidar_request(RplidarCommand::kGetConfig, std::span{payload}.first(mode ? 6 : 4));
}

std::optional<RplidarInfo> parse_rplidar_info(std::span<const std::uint8_t> answer) {
  if (answer.size() != 20) return std::nullopt;
  RplidarInfo info{answer[0], answer[2], answer[1], answer[3], {}};
  std::copy(answer.begin() + 4, answer.end(), info.serial.begin());
  return info;
}

std::optional<RplidarHealth> parse_rplidar_health(std::span<const std::uint8_t> answer) {
  if (answer.size() != 3 || answer[0] > static_cast<std::uint8_t>(RplidarHealth::kError)) return std::nullopt;
  return static_cast<RplidarHealth>(answer[0]);
}

std::optional<RplidarSampleRate> parse_rplidar_sample_rate(std::span<const std::uint8_t> answer) {
  if (answer.size() != 4) return std::nullopt;
  ByteReader reader{answer};
  const std::uint16_t standard_us = reader.u16_le();
  return RplidarSampleRate{standard_us, reader.u16_le()};
}

std::optional<RplidarConfigValue> parse_rplidar_config(std::span<const std::uint8_t> answer) {
  if (answer.size() < 5) return std::nullopt;
  ByteReader reader{answer};
  const auto key = static_cast<RplidarConfigKey>(reader.u32_le());
  std::uint32_t value = 0;
  const std::size_t bytes = std::min<std::size_t>(reader.remaining(), 4);
  for (std::size_t i = 0; i < bytes; ++i) value |= static_cast<std::uint32_t>(reader.u8()) << (8U * i);
  return RplidarConfigValue{key, value};
}

}  // namespace slamd
