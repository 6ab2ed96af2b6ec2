#pragma once
// Makes the level cut of a scan: of a 2D LiDAR all beams, of a 3D one the returns of all rings in a band of heights, or one
// ring; de-skewed by the motion. Knows no map.

#include <optional>
#include <unordered_map>
#include <vector>

#include "estimator/grid/planar_motion.hpp"
#include "estimator/grid/planar_scan.hpp"
#include "estimator/types/laser_scan.hpp"
#include "estimator/types/pose.hpp"
#include "estimator/types/scan.hpp"

namespace slamd {

struct Scan2dConfig {
  bool single_ring = false;       // 3D: the ring nearest to the LiDAR's horizon alone, above the band's low end; else all rings in the band
  double band_low_m = 0.8;        // heights above base that count, of a 3D scan
  double band_high_m = 2.8;
  double min_range_m = 0.12;      // nearer returns are the vehicle itself, from the LiDAR
  double max_range_m = 80.0;
  double spacing_m = 0.05;        // points nearer to each other become their mean; twice that, and so on, while there are more than
  std::size_t most_points = 3000;
};

class Scan2d {
 public:
  Scan2d(const VehicleGeometry& vehicle, const Scan2dConfig& config);

  /// Takes the raw points of a scan in, in the base frame with their times. Then cut() as often as the motion gets better.
  void take(const LaserScan& scan);
  void take(const Scan& scan);
  /// First and last measurement, as the seconds of `PlanarMotion` (host time, seconds since the first scan's end).
  HostTime begin() const { return begin_; }
  HostTime end() const { return end_; }

  /// The points at end(), de-skewed and levelled.
  /// up_base  unit, against gravity, in base: how the vehicle leans during the scan
  /// motion   over the scan; its seconds count from end(), so they are negative before
  void cut(const PlanarMotion& motion, const Eigen::Vector3d& up_base, PlanarScan& out);

  /// R_level_base, which turns up_base to z and has no heading.
  static Eigen::Matrix3d level_rotation(const Eigen::Vector3d& up_base);

 private:
  struct RawPoint {
    Eigen::Vector3f p_base;
    float before_end_s;  // negative
  };
  std::optional<int> level_ring(const Scan& scan) const;
  float band_high() const;
  bool is_in_reach(const Eigen::Vector3f& p_base, float range_m) const;
  void thin(double spacing_m, std::vector<Eigen::Vector2f>& out);

  VehicleGeometry vehicle_;
  Scan2dConfig config_;
  HostTime begin_, end_;
  bool has_heights_ = false;  // of a 3D scan by all rings: the band counts
  std::vector<RawPoint> raw_;
  std::vector<Eigen::Vector2f> level_;
  struct Mean {
    float x, y, count;
  };
  std::unordered_map<std::uint64_t, std::uint32_t> voxels_;
  std::vector<Mean> means_;
};

}  // namespace slamd
