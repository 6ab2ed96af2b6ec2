#pragma once
// Which cost slam-pgo minimises: the file's own information matrices, or the isotropic one of SE-Sync. No solving here.

#include "estimator/graph/chordal.hpp"
#include "estimator/graph/pose_graph.hpp"

namespace slamd::pgo {

/// The same poses and edges under SE-Sync's objective: sum of kappa ||R_j - R_i R_ij||_F^2 + tau ||t_j - t_i - R_i t_ij||^2.
/// 3D: tau = 3 / tr(Omega_t^-1), kappa = 3 / (2 tr(Omega_R^-1)); 2D: tau = 2 / tr(Omega_t^-1), kappa = Omega_yaw.
/// Source: Rosen et al. 2019, and shared/data/g2o/README.md for the weights.
template <class Group>
PoseGraph<Group> sesync(PoseGraph<Group> graph) {
  constexpr int d = Group::kDimension;
  constexpr int turns = Group::kDof - d;
  graph.rotation_error = RotationError::kChordal;  // its square is half of ||R - I||_F^2
  for (Edge<Group>& edge : graph.edges) {
    const double tau = translation_weight<Group>(edge.information);
    const double twice_kappa = (d == 2 ? 2.0 : 1.0) * rotation_weight<Group>(edge.information);
    edge.information.setZero();
    edge.information.diagonal().template head<d>().setConstant(tau);
    edge.information.diagonal().template tail<turns>().setConstant(twice_kappa);
  }
  return graph;
}

}  // namespace slamd::pgo
