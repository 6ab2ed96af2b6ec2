#pragma once
// Are two sub-maps the same place, and how do they fit together? The stages that need nothing but the two. What odometry
// says of them is the caller's business.

#include <limits>

#include "estimator/graph/bird_view.hpp"
#include "estimator/graph/loop_closer_config.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/place_descriptor.hpp"
#include "estimator/graph/relative_pose.hpp"

namespace slamd {

/// Where the source may lie in the target's level frame.
struct PlaceGuess {
  TurnAndShift T_target_source;
  double height_m = std::numeric_limits<double>::quiet_NaN();  // no number: the ground says
  PlanarWindow window;
};

/// The guess from two places that look alike.
PlaceGuess guess_of(const PlaceMatch& match);

/// The turn about the vertical and the shift of T.
TurnAndShift planar(const Pose& T);

struct PlaceCheck {
  LoopStage ended_at = LoopStage::kSearch;  // the stage that said no; kAccepted: none did
  bool registered = false;                  // T_target_source is a registration's, good or bad
  RelativePose T_target_source;             // of the level frames
  double fitness = std::numeric_limits<double>::quiet_NaN();
  double overlap = std::numeric_limits<double>::quiet_NaN();
  double free_space_share = std::numeric_limits<double>::quiet_NaN();
};

/// Search in the guess's window, registration, overlap, free space.
PlaceCheck check_place(const Submap& target, const Submap& source, const PlaceGuess& guess, const LoopCloserConfig& config);

}  // namespace slamd
