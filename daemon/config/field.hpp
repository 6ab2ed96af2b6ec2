#pragma once
// One key of a configuration file: its name, where its value lives, what it may be. Not YAML: yaml_fields reads that.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

/// Where a value lives. Duration is in seconds in the file, a quaternion is [x, y, z, w].
using FieldSlot = std::variant<bool*, int*, std::uint16_t*, std::uint32_t*, std::size_t*, float*, double*, Duration*,
                               std::string*, Eigen::Vector3d*, Eigen::Quaterniond*>;

/// Smallest and largest value allowed, both included; of a text its length, of a vector every component.
struct FieldRange {
  double min;
  double max;
};

constexpr FieldRange kAnyText{0, 4096};
constexpr FieldRange kSomeText{1, 4096};

struct Field {
  std::string key;  // sections joined by dots: "lidar.latency_s"
  FieldSlot slot;
  std::string_view unit;  // "" when the value has none
  FieldRange range;
  std::string_view doc;  // one sentence, no line break
  bool live = false;     // may change while slamd runs, by a reload
};

/// Reads the scalars of one YAML value (one, or the items of a list) into the field's slot.
/// Returns why not ("" when done); the slot is untouched then.
std::string assign(const Field& field, std::span<const std::string> scalars);

/// How many scalars assign() wants: 1, or the length of the list.
std::size_t scalar_count(const Field& field);

/// The value as YAML text, shortest form that reads back to the same bits.
std::string value_text(const Field& field);

/// "1 .. 65535", or "" where a range says nothing (bool, text, quaternion).
std::string range_text(const Field& field);

}  // namespace slamd
