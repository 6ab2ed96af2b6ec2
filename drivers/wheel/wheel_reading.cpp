#include "drivers/wheel/wheel_reading.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace slamd {
namespace {

constexpr std::string_view kAddress = "WODO";

/// The text before the next comma, which is taken off as well.
std::string_view take_field(std::string_view& rest) {
  const std::string_view field = rest.substr(0, rest.find(','));
  rest.remove_prefix(std::min(rest.size(), field.size() + 1));
  return field;
}

template <class Number>
bool read(std::string_view field, Number& value) {
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return !field.empty() && error == std::errc{} && end == field.data() + field.size();
}

}  // namespace

bool is_possible(const WheelReading& reading) {
  return std::abs(reading.x_m) <= kWheelMostMetres && std::abs(reading.y_m) <= kWheelMostMetres &&
         std::abs(reading.yaw_rad) <= kWheelMostRadians;
}

bool is_wheel_sentence(std::string_view text) {
  return text.substr(0, text.find(',')) == kAddress;
}

std::optional<WheelReading> parse_wheel_text(std::string_view text) {
  if (take_field(text) != kAddress) return std::nullopt;
  WheelReading reading;
  const bool whole = read(take_field(text), reading.device_us) && read(take_field(text), reading.x_m) &&
                     read(take_field(text), reading.y_m) && read(text, reading.yaw_rad);  // the last takes what is left
  if (!whole || !is_possible(reading)) return std::nullopt;
  return reading;
}

std::string wheel_line(const WheelReading& reading) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), "WODO,%u,%.4f,%.4f,%.6f", reading.device_us, reading.x_m, reading.y_m,
                reading.yaw_rad);
  unsigned sum = 0;
  for (const char c : std::string_view{text.data()}) sum ^= static_cast<unsigned char>(c);
  std::array<char, 8> tail{};
  std::snprintf(tail.data(), tail.size(), "*%02X\r\n", sum);
  return std::string{"$"} + text.data() + tail.data();
}

}  // namespace slamd
