#pragma once
// A sub-map seen from above, and the exhaustive search for the turn and shift that lay one view on another: the first
// guess of a registration when the pose is metres off. No refinement: that is submap_registration.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "estimator/graph/keyframe_clouds.hpp"

namespace slamd {

/// Cells of kCell_m around the sub-map's centre in which something stands upright.
class BirdView {
 public:
  static constexpr float kCell_m = 0.5F;
  static constexpr int kSize = 256;     // cells along each axis, the centre in the middle
  static constexpr int kLevels = 5;     // level l: the maximum over 2^l x 2^l cells

  explicit BirdView(const Submap& submap);

  /// The cells, as points of the level frame, metres; evenly thinned to at most kMaxCells.
  static constexpr std::size_t kMaxCells = 500;
  const std::vector<Eigen::Vector2f>& cells() const { return cells_; }
  /// 2 = something stands in one of the 2^level x 2^level cells from (ix, iy) on, 1 = beside one, 0 = nothing or outside.
  std::uint8_t at(int level, int ix, int iy) const;
  /// Height of the ground, metres in the level frame; NaN where none was seen.
  float ground_m(const Eigen::Vector2f& p) const;

  static int index(float x) { return static_cast<int>(std::floor(x / kCell_m)) + kSize / 2; }

 private:
  void pool(int level);

  std::vector<std::uint8_t> levels_[kLevels];
  std::vector<float> ground_m_;
  std::vector<Eigen::Vector2f> cells_;
};

/// A turn and a shift in the plane.
struct TurnAndShift {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

struct PlanarWindow {
  double distance_m = 0.0;  // to each side of the guess
  double yaw_rad = 0.0;
};

struct PlanarMatch {
  TurnAndShift T_target_source;
  double score = 0.0;         // 0..1, share of the source's cells that lie on the target's
  double runner_up = 0.0;     // the best score more than kApart_m away: near `score` where the place repeats itself
  double height_m = 0.0;      // of the source's frame in the target's, from their ground
  static constexpr double kApart_m = 3.0;
};

/// The best match inside the window around the guess, exactly, on the cells' grid and steps of yaw of 1.5 degrees.
/// Branch and bound over the levels. Source: Hess et al. 2016, section V.B.
PlanarMatch search(const BirdView& target, const BirdView& source, const TurnAndShift& guess, const PlanarWindow& window);

}  // namespace slamd
