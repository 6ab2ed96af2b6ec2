#include "daemon/threads/map_placement.hpp"

namespace slamd {

MapPlacement::Placed MapPlacement::place(const NavState& state, const MapLink& link) {
  const bool placed = link.places(state);
  if (placed) {
    T_map_odom_ = link.T_map_odom;
    guessed_.reset();
  } else if (guessed_ != state.odom_piece) {
    T_map_odom_ = T_map_base_ * state.T_odom_base.inverse();
    guessed_ = state.odom_piece;
  }
  T_map_base_ = T_map_odom_ * state.T_odom_base;
  return {placed ? state : unplaced(state), T_map_odom_};
}

}  // namespace slamd
