#include "tools/plot/grid_file.hpp"

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>

namespace slamd::plot {
namespace {

constexpr std::size_t kMostCells = 1U << 28U;

/// Binary PGM (P5) of one byte a pixel.
void read_pgm(const std::string& path, GridImage& grid) {
  std::ifstream in{path, std::ios::binary};
  if (!in) throw GridError(path + ": cannot be opened");
  std::string magic;
  std::size_t most = 0;
  in >> magic >> std::ws;
  while (in.peek() == '#') in.ignore(1 << 16, '\n') >> std::ws;
  in >> grid.columns >> grid.rows >> most;
  if (!in || magic != "P5" || most != 255) throw GridError(path + ": no binary PGM with one byte a pixel");
  if (grid.columns == 0 || grid.rows == 0 || grid.columns > kMostCells / grid.rows) throw GridError(path + ": impossible size");
  in.ignore(1);
  grid.grey.resize(grid.columns * grid.rows);
  in.read(reinterpret_cast<char*>(grid.grey.data()), static_cast<std::streamsize>(grid.grey.size()));
  if (!in) throw GridError(path + ": ends before its last pixel");
}

}  // namespace

GridImage load_grid(const std::string& yaml_path) {
  GridImage grid;
  std::string image;
  try {
    const YAML::Node yaml = YAML::LoadFile(yaml_path);
    image = yaml["image"].as<std::string>();
    grid.resolution_m = yaml["resolution"].as<double>();
    grid.x_m = yaml["origin"][0].as<double>();
    grid.y_m = yaml["origin"][1].as<double>();
  } catch (const YAML::Exception& error) {
    throw GridError(yaml_path + ": " + error.what());
  }
  if (!(grid.resolution_m > 0.0)) throw GridError(yaml_path + ": resolution is not positive");
  read_pgm((std::filesystem::path{yaml_path}.parent_path() / image).string(), grid);
  return grid;
}

}  // namespace slamd::plot
