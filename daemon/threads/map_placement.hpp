#pragma once
// Where in map each told pose is put: by the back end's link, or by a guess that says so while there is none. Real-time; it
// estimates nothing.

#include <cstdint>
#include <optional>

#include "estimator/graph/map_link.hpp"

namespace slamd {

class MapPlacement {
 public:
  /// T_map_base  where the vehicle is believed to be before anything is known
  explicit MapPlacement(const Pose& T_map_base = {}) : T_map_base_{T_map_base} {}

  struct Placed {
    NavState state;    // as it is to be told
    Pose T_map_odom;
  };
  /// While the piece of odometry has no place in map the pose goes on from the last one that was told, marked as unplaced.
  Placed place(const NavState& state, const MapLink& link);

 private:
  Pose T_map_base_;                       // as told last
  Pose T_map_odom_;
  std::optional<std::uint32_t> guessed_;  // the piece that T_map_odom_ is a guess for
};

}  // namespace slamd
