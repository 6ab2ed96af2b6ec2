#pragma once
// Points with intensity in one frame, which the owner's comment names. No structure, no search: that is estimator/map.

#include <cstdint>
#include <vector>

namespace slamd {

struct CloudPoint {
  float x, y, z;    // metres
  float intensity;  // 0..255
};

using PointCloud = std::vector<CloudPoint>;

}  // namespace slamd
