#pragma once
// What is asked and answered when a piece of odometry, which nothing joins to the map, is looked for in it. Values alone:
// looking is the LoopSource's.

#include <cstddef>
#include <optional>

#include "estimator/graph/bird_view.hpp"
#include "estimator/graph/keyframe_clouds.hpp"
#include "estimator/graph/odometry_chain.hpp"
#include "estimator/graph/relative_pose.hpp"

namespace slamd {

/// A piece of odometry as far as it has come: its own chain, and the points of the same keyframes.
struct PieceView {
  const OdometryChain& odometry;
  const KeyframeClouds& clouds;
};

/// Where the newest keyframe of a piece is believed to be, how far it may be from there, horizontally and in heading, and how far from
/// any keyframe of the map.
struct PlaceBelief {
  Pose T_map_base;
  PlanarWindow window{.distance_m = 8.0, .yaw_rad = 0.5};
  double reach_m = 8.0;
};

/// The newest keyframe of a piece, found again by registration.
struct Recognition {
  std::size_t place = 0;           // keyframe of the map
  std::size_t keyframe = 0;        // of the piece
  RelativePose T_place_keyframe;   // of their bases
  bool by_looks = false;           // no belief pointed there: it may be another place that looks alike
};

}  // namespace slamd
