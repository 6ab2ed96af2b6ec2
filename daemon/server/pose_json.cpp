#include "daemon/server/pose_json.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "estimator/types/nav_state.hpp"

namespace slamd {
namespace {

constexpr std::size_t kUsualBytes = 2048;

/// As short as it comes back the same.
template <class Number>
std::string_view digits_of(Number value, std::array<char, 32>& room) {
  const auto written = std::to_chars(room.data(), room.data() + room.size(), value);
  return {room.data(), static_cast<std::size_t>(written.ptr - room.data())};
}

template <class Integer>
void append(std::string& text, Integer value) {
  std::array<char, 32> room;
  text += digits_of(value, room);
}

void append(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  std::array<char, 32> room;
  const std::string_view digits = digits_of(value, room);
  text += digits;
  if (digits.find_first_of(".e") == std::string_view::npos) text += ".0";  // so that nobody takes it for an integer
}

template <std::size_t kSize>
void append(std::string& text, const std::array<double, kSize>& values) {
  char separator = '[';
  for (const double value : values) {
    text += separator;
    append(text, value);
    separator = ',';
  }
  text += ']';
}

/// Key and value; the key comes with what stands before it.
template <class Value>
void append(std::string& text, std::string_view key, const Value& value) {
  text += key;
  append(text, value);
}

}  // namespace

nlohmann::json reason_names(std::uint32_t reasons) {
  nlohmann::json names = nlohmann::json::array();
  for (std::uint32_t bit = 1; bit != 0 && bit <= reasons; bit <<= 1U) {
    if ((reasons & bit) != 0) names.push_back(name(static_cast<StatusReason>(bit)));
  }
  return names;
}

std::string pose_text(const PoseSample& sample) {
  std::string text;
  text.reserve(kUsualBytes);
  append(text, R"({"time_ns":)", sample.host_time_ns);
  if (sample.utc_offset_ns == kUtcOffsetUnknown) text += R"(,"utc_offset_ns":null)";
  else append(text, R"(,"utc_offset_ns":)", sample.utc_offset_ns);
  append(text, R"(,"sequence":)", sample.sequence);
  text += R"(,"status":")";
  text += name(static_cast<TrackingStatus>(sample.status));
  text += R"(","reasons":)";
  text += sample.reasons == 0 ? "[]" : reason_names(sample.reasons).dump();
  append(text, R"(,"T_map_base":{"translation_m":)", sample.map_position_m);
  append(text, R"(,"rotation_quat_xyzw":)", sample.map_rotation_xyzw);
  append(text, R"(},"T_odom_base":{"translation_m":)", sample.odom_position_m);
  append(text, R"(,"rotation_quat_xyzw":)", sample.odom_rotation_xyzw);
  append(text, R"(},"velocity_mps":)", sample.velocity_mps);
  append(text, R"(,"angular_velocity_rads":)", sample.angular_velocity_rads);
  append(text, R"(,"covariance":)", sample.covariance);
  append(text, R"(,"degenerate_direction":)", sample.degenerate_direction);
  append(text, R"(,"lidar_test_ratio":)", double{sample.lidar_test_ratio});
  append(text, R"(,"map_corrections":)", sample.map_corrections);
  text += '}';
  return text;
}

}  // namespace slamd
