#pragma once
// Where the map lies on the earth, as the back end found out from GPS. A plain value; no geodesy.

#include "estimator/types/pose.hpp"

namespace slamd {

/// p_enu = T_enu_map * p_map; enu is tangential to WGS-84 at the origin: east, north, up.
struct GeoReference {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
  Pose T_enu_map;
};

}  // namespace slamd
