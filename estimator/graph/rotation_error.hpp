#pragma once
// How a factor measures an error of rotation. Both agree to first order; only their cost far from zero differs.

#include <cstdint>

namespace slamd {

enum class RotationError : std::uint8_t {
  kLog,      // the rotation vector: what covariances of slamd and g2o's information matrices mean
  kChordal,  // 2 sin(angle / 2) about the same axis: its square is ||R - I||_F^2 / 2, the objective of SE-Sync
};

}  // namespace slamd
