#include "estimator/graph/packed_cloud.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {
namespace {

constexpr std::uint32_t kXySteps = 32;
constexpr std::uint32_t kZSteps = 64;

struct Voxel {
  std::uint32_t number;
  std::uint32_t point;  // the first one in it
};

/// Neighbours in y have neighbouring numbers: most of what lies side by side is ground or rings on walls.
std::uint32_t number_of(const Eigen::Vector3i& cell, int cells) {
  return static_cast<std::uint32_t>((cell.z() * cells + cell.x()) * cells + cell.y());
}

Eigen::Vector3i cell_of(std::uint32_t number, int cells) {
  const int rest = static_cast<int>(number) / cells;
  return {rest % cells, static_cast<int>(number) % cells, rest / cells};
}

/// In voxels, from the grid's corner.
Eigen::Vector3f from_corner(const CloudPoint& p, const CloudGrid& grid) {
  return (Eigen::Vector3f{p.x, p.y, p.z}.array() + grid.max_range_m) / grid.voxel_size_m;
}

std::vector<Voxel> first_points(std::span<const CloudPoint> points, const CloudGrid& grid) {
  std::vector<Voxel> voxels;
  voxels.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const CloudPoint& p = points[i];
    if (!(p.x * p.x + p.y * p.y + p.z * p.z < grid.max_range_m * grid.max_range_m)) continue;
    const Eigen::Vector3i cell = from_corner(p, grid).array().floor().matrix().cast<int>();
    voxels.push_back({number_of(cell, grid.cells()), i});
  }
  std::ranges::sort(voxels, [](const Voxel& a, const Voxel& b) {
    return a.number != b.number ? a.number < b.number : a.point < b.point;
  });
  const auto same = [](const Voxel& a, const Voxel& b) { return a.number == b.number; };
  voxels.erase(std::unique(voxels.begin(), voxels.end(), same), voxels.end());
  return voxels;
}

std::uint32_t step_of(float in_cell, std::uint32_t steps) {
  return std::min(static_cast<std::uint32_t>(in_cell * static_cast<float>(steps)), steps - 1);
}

void append(std::vector<std::uint8_t>& bytes, std::uint32_t voxels_on, std::uint32_t place) {
  for (; voxels_on >= 0x80U; voxels_on >>= 7U) bytes.push_back(static_cast<std::uint8_t>(voxels_on | 0x80U));
  bytes.push_back(static_cast<std::uint8_t>(voxels_on));
  bytes.push_back(static_cast<std::uint8_t>(place));
  bytes.push_back(static_cast<std::uint8_t>(place >> 8U));
}

}  // namespace

std::vector<std::uint8_t> pack_cloud(std::span<const CloudPoint> points_base, const CloudGrid& grid) {
  const std::vector<Voxel> voxels = first_points(points_base, grid);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * voxels.size());
  std::uint32_t before = 0;
  for (const Voxel& voxel : voxels) {
    const Eigen::Vector3f p = from_corner(points_base[voxel.point], grid);
    const Eigen::Vector3f in_cell = p - p.array().floor().matrix();
    append(bytes, voxel.number - before,
           step_of(in_cell.x(), kXySteps) | step_of(in_cell.y(), kXySteps) << 5U | step_of(in_cell.z(), kZSteps) << 10U);
    before = voxel.number;
  }
  bytes.shrink_to_fit();
  return bytes;
}

bool is_packed_cloud(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMostVoxelBytes = 5;  // of a step of 32 bits
  constexpr std::size_t kPlaceBytes = 2;
  for (std::size_t i = 0; i < bytes.size(); i += kPlaceBytes) {
    const std::size_t begin = i;
    while (i < bytes.size() && (bytes[i] & 0x80U) != 0) ++i;
    ++i;
    if (i - begin > kMostVoxelBytes || i + kPlaceBytes > bytes.size()) return false;
  }
  return true;
}

void unpack_cloud(std::span<const std::uint8_t> packed, const CloudGrid& grid,
                  const std::function<void(const Eigen::Vector3f&)>& take) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < packed.size();) {
    std::uint32_t voxels_on = 0;
    for (std::uint32_t shift = 0;; shift += 7) {
      voxels_on |= (packed[i] & 0x7FU) << shift;
      if ((packed[i++] & 0x80U) == 0) break;
    }
    number += voxels_on;
    const std::uint32_t place = packed[i] | static_cast<std::uint32_t>(packed[i + 1]) << 8U;
    i += 2;
    const Eigen::Vector3f in_cell{(static_cast<float>(place & 31U) + 0.5F) / kXySteps,
                                  (static_cast<float>(place >> 5U & 31U) + 0.5F) / kXySteps,
                                  (static_cast<float>(place >> 10U) + 0.5F) / kZSteps};
    const Eigen::Vector3f p = cell_of(number, grid.cells()).cast<float>() + in_cell;
    take((p.array() * grid.voxel_size_m - grid.max_range_m).matrix());
  }
}

}  // namespace slamd
