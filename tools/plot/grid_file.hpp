#pragma once
// Reader of occupancy grids as map_server of ROS and of nav2 write them: a YAML file and the PGM that it names. Draws nothing.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace slamd::plot {

struct GridImage {
  std::size_t columns = 0;
  std::size_t rows = 0;
  double resolution_m = 0.0;         // of a cell
  double x_m = 0.0, y_m = 0.0;       // lower left corner
  std::vector<std::uint8_t> grey;    // rows from the highest y down; 0 occupied, 254 free, 205 unknown
};

/// A grid that cannot be read; what() names file and reason.
class GridError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// yaml_path  its `image` is relative to its own folder. Throws GridError.
GridImage load_grid(const std::string& yaml_path);

}  // namespace slamd::plot
