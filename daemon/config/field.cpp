#include "daemon/config/field.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <type_traits>

namespace slamd {
namespace {

template <class Number>
std::optional<Number> read_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string number_text(double value) {
  char fixed[400];
  const auto in_fixed = std::to_chars(fixed, fixed + sizeof fixed, value, std::chars_format::fixed);
  const std::string text{fixed, in_fixed.ptr};
  if (text.size() <= 17) return text;
  char shortest[64];
  return {shortest, std::to_chars(shortest, shortest + sizeof shortest, value).ptr};
}

std::string number_text(float value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string bounds(const FieldRange& range) {
  return number_text(range.min) + " .. " + number_text(range.max);
}

std::string out_of_range(const Field& field) {
  return "must be in " + bounds(field.range);
}

bool inside(const FieldRange& range, double value) {
  return std::isfinite(value) && value >= range.min && value <= range.max;
}

/// Reads `N` numbers within the range; empty reason on success.
template <std::size_t N>
std::string read_reals(const Field& field, std::span<const std::string> scalars, std::array<double, N>& out) {
  for (std::size_t i = 0; i < N; ++i) {
    const auto value = read_number<double>(scalars[i]);
    if (!value || !std::isfinite(*value)) return "not a number: '" + scalars[i] + "'";
    if (!inside(field.range, *value)) return out_of_range(field);
    out[i] = *value;
  }
  return {};
}

/// One overload a slot type: reads the scalars into *slot or says why not.
struct Assigner {
  const Field& field;
  std::span<const std::string> scalars;

  std::string operator()(bool* slot) const {
    if (scalars[0] != "true" && scalars[0] != "false") return "not true or false: '" + scalars[0] + "'";
    *slot = scalars[0] == "true";
    return {};
  }
  template <class Integer>
  requires std::is_integral_v<Integer> std::string operator()(Integer* slot) const {
    const auto value = read_number<std::int64_t>(scalars[0]);
    if (!value) return "not a whole number: '" + scalars[0] + "'";
    if (!inside(field.range, static_cast<double>(*value))) return out_of_range(field);
    *slot = static_cast<Integer>(*value);
    return {};
  }
  std::string operator()(double* slot) const {
    std::array<double, 1> value;
    std::string reason = read_reals(field, scalars, value);
    if (reason.empty()) *slot = value[0];
    return reason;
  }
  std::string operator()(float* slot) const {
    const auto value = read_number<float>(scalars[0]);
    if (!value || !std::isfinite(*value)) return "not a number: '" + scalars[0] + "'";
    if (!inside(field.range, static_cast<double>(*value))) return out_of_range(field);
    *slot = *value;
    return {};
  }
  std::string operator()(Duration* slot) const {
    double seconds = 0.0;
    std::string reason = (*this)(&seconds);
    if (reason.empty()) *slot = from_seconds(seconds);
    return reason;
  }
  std::string operator()(std::string* slot) const {
    const std::string& text = scalars[0];
    if (!inside(field.range, static_cast<double>(text.size()))) {
      return text.empty() ? "must not be empty" : "is too long";
    }
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    if (std::any_of(text.begin(), text.end(), is_control)) return "has control characters";
    *slot = text;
    return {};
  }
  std::string operator()(Eigen::Vector3d* slot) const {
    std::array<double, 3> v;
    std::string reason = read_reals(field, scalars, v);
    if (reason.empty()) *slot = {v[0], v[1], v[2]};
    return reason;
  }
  std::string operator()(Eigen::Quaterniond* slot) const {
    std::array<double, 4> q;
    if (std::string reason = read_reals(field, scalars, q); !reason.empty()) return reason;
    const Eigen::Quaterniond read{q[3], q[0], q[1], q[2]};
    if (std::abs(read.norm() - 1.0) > 1e-3) return "not a unit quaternion [x, y, z, w]";
    *slot = std::abs(read.norm() - 1.0) > 1e-9 ? read.normalized() : read;
    return {};
  }
};

struct Formatter {
  std::string operator()(const bool* slot) const { return *slot ? "true" : "false"; }
  template <class Integer>
  requires std::is_integral_v<Integer> std::string operator()(const Integer* slot) const {
    return std::to_string(*slot);
  }
  std::string operator()(const float* slot) const { return number_text(*slot); }
  std::string operator()(const double* slot) const { return number_text(*slot); }
  std::string operator()(const Duration* slot) const { return number_text(static_cast<double>(slot->count()) / 1e9); }
  std::string operator()(const std::string* slot) const { return quoted(*slot); }
  std::string operator()(const Eigen::Vector3d* slot) const {
    return "[" + number_text(slot->x()) + ", " + number_text(slot->y()) + ", " + number_text(slot->z()) + "]";
  }
  std::string operator()(const Eigen::Quaterniond* slot) const {
    return "[" + number_text(slot->x()) + ", " + number_text(slot->y()) + ", " + number_text(slot->z()) + ", " +
           number_text(slot->w()) + "]";
  }
};

}  // namespace

std::string assign(const Field& field, std::span<const std::string> scalars) {
  return std::visit(Assigner{field, scalars}, field.slot);
}

std::size_t scalar_count(const Field& field) {
  if (std::holds_alternative<Eigen::Vector3d*>(field.slot)) return 3;
  if (std::holds_alternative<Eigen::Quaterniond*>(field.slot)) return 4;
  return 1;
}

std::string value_text(const Field& field) {
  return std::visit(Formatter{}, field.slot);
}

std::string range_text(const Field& field) {
  if (std::holds_alternative<bool*>(field.slot) || std::holds_alternative<std::string*>(field.slot) ||
      std::holds_alternative<Eigen::Quaterniond*>(field.slot)) {
    return {};
  }
  return bounds(field.range);
}

}  // namespace slamd
