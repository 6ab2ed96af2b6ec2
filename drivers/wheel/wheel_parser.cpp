#include "drivers/wheel/wheel_parser.hpp"

namespace slamd {

std::optional<WheelReading> WheelParser::take(std::uint8_t byte) {
  const std::optional<std::string_view> text = lines_.take(byte);
  if (!text) return std::nullopt;
  if (!is_wheel_sentence(*text)) {
    ++stats_.other;
    return std::nullopt;
  }
  const std::optional<WheelReading> reading = parse_wheel_text(*text);
  if (!reading) ++stats_.malformed;
  return reading;
}

}  // namespace slamd
