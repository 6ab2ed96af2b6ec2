#include "tools/slam-replay/bag/cloud_fields.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>

namespace slamd::replay {
namespace {

constexpr std::array<std::uint8_t, 9> kSizes{0, 1, 1, 2, 2, 4, 4, 4, 8};  // by datatype
constexpr std::size_t kMostRings = 128;  // Segmenter::kMaxRings

using Field = PointCloud2Message::Field;

template <class Number>
double as(const std::uint8_t* at, bool swaps) {
  std::array<std::uint8_t, sizeof(Number)> raw;
  std::memcpy(raw.data(), at, raw.size());
  if (swaps) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Number>(raw));
}

double value(const std::uint8_t* point, const Field& field, bool swaps) {
  const std::uint8_t* const at = point + field.offset;
  switch (field.datatype) {
    case 1: return as<std::int8_t>(at, swaps);
    case 2: return as<std::uint8_t>(at, swaps);
    case 3: return as<std::int16_t>(at, swaps);
    case 4: return as<std::uint16_t>(at, swaps);
    case 5: return as<std::int32_t>(at, swaps);
    case 6: return as<std::uint32_t>(at, swaps);
    case 7: return as<float>(at, swaps);
    default: return as<double>(at, swaps);
  }
}

/// The first of the names that is there and lies within a point; null: none.
const Field* find(const PointCloud2Message& cloud, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const Field& field : cloud.fields) {
      const bool fits = field.datatype >= 1 && field.datatype <= 8 &&
                        std::uint64_t{field.offset} + kSizes[field.datatype] <= cloud.point_step;
      if (field.name == name && fits) return &field;
    }
  }
  return nullptr;
}

struct Layout {
  const Field *x, *y, *z, *intensity, *ring, *time;
  bool swaps;
  bool rows_are_rings;
  bool columns_are_rings;
};

CloudPoint point_of(const std::uint8_t* at, const Layout& layout, std::size_t row, std::size_t column) {
  const auto read = [&](const Field* field) { return field == nullptr ? 0.0 : value(at, *field, layout.swaps); };
  CloudPoint point;
  point.x = static_cast<float>(read(layout.x));
  point.y = static_cast<float>(read(layout.y));
  point.z = static_cast<float>(read(layout.z));
  point.intensity = static_cast<float>(read(layout.intensity));
  point.time = read(layout.time);
  double ring = read(layout.ring);
  if (layout.rows_are_rings) ring = static_cast<double>(row);
  if (layout.columns_are_rings) ring = static_cast<double>(column);
  point.ring = ring >= 0.0 && ring < kMostRings ? static_cast<std::uint8_t>(ring) : std::uint8_t{kMostRings - 1};
  return point;
}

bool is_return(const CloudPoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.time) && (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

}  // namespace

std::optional<CloudPoints> read_points(const PointCloud2Message& cloud) {
  Layout layout{find(cloud, {"x"}), find(cloud, {"y"}), find(cloud, {"z"}), find(cloud, {"intensity", "i", "reflectivity"}),
                find(cloud, {"ring", "channel", "line", "laser_id", "scan_id"}),
                find(cloud, {"time", "t", "timestamp", "time_stamp", "offset_time", "time_offset", "timeOffset"}),
                cloud.is_big_endian != (std::endian::native == std::endian::big), false, false};
  const auto is_real = [](const Field* field) { return field != nullptr && field->datatype >= 7; };
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_step;
  const std::uint64_t row_step = cloud.height <= 1 || cloud.row_step == 0 ? row_bytes : cloud.row_step;
  const bool fits = cloud.height > 0 && cloud.width > 0 && row_step >= row_bytes && cloud.bytes.size() >= row_bytes &&
                    cloud.height - 1 <= (cloud.bytes.size() - row_bytes) / std::max<std::uint64_t>(1, row_step);
  if (!is_real(layout.x) || !is_real(layout.y) || !is_real(layout.z)) return std::nullopt;
  if (cloud.height == 0 || cloud.width == 0) return CloudPoints{};
  if (!fits) return std::nullopt;
  layout.rows_are_rings = layout.ring == nullptr && cloud.height > 1 && cloud.height <= kMostRings && cloud.width > cloud.height;
  layout.columns_are_rings = layout.ring == nullptr && cloud.width > 1 && cloud.width <= kMostRings && cloud.height > cloud.width;
  CloudPoints out;
  out.has_ring = layout.ring != nullptr || layout.rows_are_rings || layout.columns_are_rings;
  out.has_time = layout.time != nullptr;
  const std::size_t count = std::size_t{cloud.height} * cloud.width;
  std::size_t every = (count + kMostCloudPoints - 1) / kMostCloudPoints;
  if (every > 1) every |= 1U;  // odd: of a firing of 2^n lasers each keeps its share
  out.points.reserve(count / every + 1);
  for (std::size_t i = 0; i < count; i += every) {
    const std::size_t row = i / cloud.width;
    const std::size_t column = i % cloud.width;
    const CloudPoint point = point_of(cloud.bytes.data() + row * row_step + column * cloud.point_step, layout, row, column);
    if (is_return(point)) out.points.push_back(point);
  }
  return out;
}

}  // namespace slamd::replay
