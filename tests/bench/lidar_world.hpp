#pragma once
// Points as a 16-beam LiDAR sees them on a drive past buildings and trees, for benchmarks of the map. A crude world on
// purpose: surfaces, spacing and order of the points matter here, not truth; slam-sim is the simulator.

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

namespace slamd::bench {

struct Box {
  Eigen::Vector3f lo, hi;
};

class LidarWorld {
 public:
  LidarWorld() {
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (float x = -40.0F; x < 2'000.0F; x += 30.0F) {
      for (const float side : {-1.0F, 1.0F}) {
        const float y = side * (14.0F + 18.0F * unit(random_));
        const float width = 8.0F + 14.0F * unit(random_);
        boxes_.push_back(
            {{x, std::min(y, y + side * 12), 0}, {x + width, std::max(y, y + side * 12), 5 + 12 * unit(random_)}});
        crowns_.emplace_back(x + 20.0F + 6.0F * unit(random_), side * (8.0F + 6.0F * unit(random_)), 4.5F);
      }
    }
  }

  /// One scan from the vehicle after `travelled` metres, thinned to every `stride`-th azimuth; ring after ring as the
  /// filter takes them, in the world's frame.
  std::vector<Eigen::Vector3f> scan(float travelled, int stride) {
    const Eigen::Vector3f from(travelled, 4.0F * std::sin(travelled / 40.0F), 1.9F);
    std::normal_distribution<float> noise(0.0F, 0.02F);
    std::vector<Eigen::Vector3f> points;
    for (int ring = 0; ring < 16; ++ring) {
      const float elevation = (static_cast<float>(2 * ring) - 15.0F) * 0.01745F;
      for (int column = ring % stride; column < 1800; column += stride) {
        const float azimuth = static_cast<float>(column) * 0.2F * 0.01745F;
        const Eigen::Vector3f beam(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                   std::sin(elevation));
        const float range = cast(from, beam);
        if (range < 100.0F) points.push_back(from + (range + noise(random_)) * beam);
      }
    }
    return points;
  }

 private:
  static float cast_box(const Box& box, const Eigen::Vector3f& from, const Eigen::Vector3f& beam) {
    const Eigen::Array3f a = (box.lo - from).array() / beam.array();
    const Eigen::Array3f b = (box.hi - from).array() / beam.array();
    const float enter = a.min(b).maxCoeff();
    return enter > 0.0F && enter < a.max(b).minCoeff() ? enter : 1e9F;
  }

  float cast(const Eigen::Vector3f& from, const Eigen::Vector3f& beam) {
    float range = beam.z() < 0.0F ? -from.z() / beam.z() : 1e9F;
    for (const Box& box : boxes_)
      if (std::abs(box.lo.x() - from.x()) < 120.0F) range = std::min(range, cast_box(box, from, beam));
    std::uniform_real_distribution<float> depth(-1.0F, 1.0F);  // leaves let the beam in to a random depth
    for (const Eigen::Vector3f& crown : crowns_) {
      if (std::abs(crown.x() - from.x()) > 100.0F) continue;
      const float along = (crown - from).dot(beam);
      const float half_squared = 5.0F - ((crown - from) - along * beam).squaredNorm();
      if (along > 0.0F && half_squared > 0.0F)
        range = std::min(range, along + depth(random_) * std::sqrt(half_squared));
    }
    return range;
  }

  std::mt19937 random_{7};
  std::vector<Box> boxes_;
  std::vector<Eigen::Vector3f> crowns_;
};

}  // namespace slamd::bench
