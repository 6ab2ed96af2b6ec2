#pragma once
// The rays of one scan by their directions: asked whether a point of another scan was seen again, or was shone through.
// It holds no map and draws no conclusion: one scan is one witness.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimator/types/keyframe.hpp"

namespace slamd {

class RayImage {
 public:
  enum class Witness : std::uint8_t {
    kNothing,  // no ray came near enough, or the point lies on the surface that the ray hit further on
    kSeen,     // a ray ended there
    kPassed,   // a ray, and its neighbours, went through and ended clearly beyond
  };

  RayImage();

  /// Draws the scan. Where the sensor was at each firing follows from the twist at the scan's end and from the azimuth,
  /// counted from that of the first point: one turn clockwise in keyframe.scan_span.
  void draw(const Keyframe& keyframe, const Pose& T_base_lidar);

  /// p  lidar frame at the scan's end, metres. normal  the surface's at p, unit, or zero when unknown.
  Witness ask(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;

  /// Normal of the surface at p, a point of this scan, from neighbouring rays; zero where they do not agree on one.
  Eigen::Vector3f normal_at(const Eigen::Vector3f& p) const;

 private:
  static constexpr int kRows = 16;      // a laser each
  static constexpr int kColumns = 900;  // 0.4 degrees each, two firings at 600 rpm

  struct Ray {
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();  // unit
    float range_m = 0.0F;                                 // 0: nothing came back here
  };
  struct Cell {
    int row, column;
  };

  const Ray& ray(int row, int column) const;
  Eigen::Vector3f end_of(Cell cell) const;
  std::optional<Cell> cell_of(const Eigen::Vector3f& from_sensor) const;
  void place_sensor(const Keyframe& keyframe, const Pose& T_base_lidar);
  bool is_edge(Cell cell, float range_m) const;
  bool lies_on_surface_of(Cell cell, const Eigen::Vector3f& p) const;
  Eigen::Vector3f normal_of(Cell cell, int other_row) const;

  std::vector<Ray> rays_;                             // row by row
  std::array<Eigen::Vector3f, kColumns> sensor_;      // where the sensor was when it fired there
};

}  // namespace slamd
