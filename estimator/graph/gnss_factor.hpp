#pragma once
// The antenna's position in ENU: ties a keyframe, with the lever arm, to the alignment of map in ENU. Whitened; its robust
// loss is the caller's.

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "estimator/graph/gnss_position.hpp"
#include "estimator/graph/group_se3.hpp"

namespace slamd {

/// The alignment as a variable: translation of map in enu (m), yaw (rad). Additive, so it needs no manifold.
struct EnuBlock {
  static constexpr int kSize = 4;
  static void store(const EnuAlignment& enu, double* block);
  static EnuAlignment load(const double* block);
};

/// r = (Rz(yaw) * (T_map_base * p_base_antenna) + t - p_enu) / sigma, an axis. Blocks: keyframe, alignment.
class GnssFactor final : public ceres::SizedCostFunction<3, GroupSe3::kSize, EnuBlock::kSize> {
 public:
  explicit GnssFactor(const GnssPosition& position)
      : p_base_antenna_{position.p_keyframe_antenna},
        p_enu_{position.p_enu},
        inverse_sigma_{position.sigma_m.cwiseInverse()} {}

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  Eigen::Vector3d p_base_antenna_, p_enu_, inverse_sigma_;
};

}  // namespace slamd
