#pragma once
// Random points for tests of maps. Not random states: those are in random_states.hpp.

#include <Eigen/Core>
#include <cstddef>
#include <random>
#include <vector>

namespace slamd {

/// n points, each coordinate uniform in [-half, half).
inline std::vector<Eigen::Vector3f> uniform(std::mt19937& random, std::size_t n, const Eigen::Vector3f& half) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::vector<Eigen::Vector3f> points(n);
  for (Eigen::Vector3f& p : points)
    for (int a = 0; a < 3; ++a) p[a] = half[a] * unit(random);
  return points;
}

}  // namespace slamd
