#pragma once
// Chordal initialisation: poses from edges alone by two linear problems, near enough to the optimum for Gauss-Newton. Uses
// no initial guess but the fixed poses. Source: Carlone et al. 2015, "Initialization techniques for 3D SLAM", section IV.

#include <vector>

#include "estimator/graph/pose_graph.hpp"

namespace slamd {

/// Moves every pose that is not fixed. Each connected part needs a fixed pose (anchor_parts).
/// weights  one an edge, >= 0; empty = all 1
/// False when the linear problem has no solution (a part without a fixed pose, weights of 0); poses as they were then.
template <class Group>
[[nodiscard]] bool initialise_chordal(PoseGraph<Group>& graph, const std::vector<double>& weights = {});

/// Isotropic parts of an information matrix, as SE-Sync takes them: of translation, 1 / m^2 ...
template <class Group>
double translation_weight(const typename Group::Matrix& information);
/// ... and of rotation, 1 / rad^2, by the angle.
template <class Group>
double rotation_weight(const typename Group::Matrix& information);

}  // namespace slamd
