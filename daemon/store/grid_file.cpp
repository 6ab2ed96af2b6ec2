#include "daemon/store/grid_file.hpp"

#include <array>
#include <cstdio>

namespace slamd {
namespace {

constexpr char kOccupiedGrey = 0;
constexpr auto kFreeGrey = static_cast<char>(254);
constexpr auto kUnknownGrey = static_cast<char>(205);

char grey(std::int8_t cell) {
  if (cell == kOccupiedCell) return kOccupiedGrey;
  return cell == kFreeCell ? kFreeGrey : kUnknownGrey;
}

}  // namespace

std::string grid_picture(const OccupancyGrid& grid) {
  std::string out = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  out.reserve(out.size() + grid.cells.size());
  for (std::size_t row = grid.height; row-- > 0;) {
    for (std::size_t column = 0; column < grid.width; ++column) out += grey(grid.cells[row * grid.width + column]);
  }
  return out;
}

std::string grid_yaml(const OccupancyGrid& grid, const std::string& picture) {
  std::array<char, 256> place;
  std::snprintf(place.data(), place.size(), "resolution: %.9g\norigin: [%.9g, %.9g, 0]\n", grid.resolution_m, grid.origin.x(),
                grid.origin.y());
  return "image: " + picture + "\nmode: trinary\n" + place.data() + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

}  // namespace slamd
