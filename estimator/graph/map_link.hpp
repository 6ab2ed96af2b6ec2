#pragma once
// Where a piece of odometry lies in the map, and what is told of a pose as long as that is not known. Values alone.

#include <cstdint>

#include "estimator/types/nav_state.hpp"

namespace slamd {

struct MapLink {
  Pose T_map_odom;                // of the piece below; a guess when it is not known
  std::uint32_t odom_piece = 0;   // NavState::odom_piece
  bool known = true;              // false: the piece is being looked for in the map

  bool operator==(const MapLink& other) const {
    return T_map_odom.translation == other.T_map_odom.translation && odom_piece == other.odom_piece &&
           T_map_odom.rotation.coeffs() == other.T_map_odom.rotation.coeffs() && known == other.known;
  }
  bool places(const NavState& state) const { return known && state.odom_piece == odom_piece; }
};

/// A pose whose place in map is not known: DEGRADED relocalising, with a covariance that excludes nothing within kilometres.
NavState unplaced(NavState state);

}  // namespace slamd
