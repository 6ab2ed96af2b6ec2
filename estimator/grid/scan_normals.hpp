#pragma once
// How the wall runs at each point of a scan, from its neighbours in the same scan. Walls of many scans are line_map's.

#include "estimator/grid/planar_scan.hpp"

namespace slamd {

/// Sorts the points by their direction from the LiDAR and fills the normals: towards the LiDAR, zero where the neighbours within
/// a reach that grows with range are fewer than three or lie on no line.
/// spacing_m  of the points: the reach is three of it at least
void find_normals(PlanarScan& scan, double spacing_m);

}  // namespace slamd
