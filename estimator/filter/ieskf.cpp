#include "estimator/filter/ieskf.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace slamd {

using I = ErrorIndex;

namespace {

struct FreeDirections {
  int count = 0;
  Eigen::Vector3d weakest = Eigen::Vector3d::Zero();
};

/// Information on the three states at `row` with the three at `other` marginalised out (Schur complement).
Eigen::Matrix3d marginal(const MeasuredMatrix& a, int row, int other) {
  const Eigen::Matrix3d b = a.block<3, 3>(row, other);
  const Eigen::Matrix3d c = a.block<3, 3>(other, other);
  const double damping = 1e-9 * c.trace() + 1e-12;
  const Eigen::Matrix3d inner = (c + damping * Eigen::Matrix3d::Identity()).inverse();
  return a.block<3, 3>(row, row) - b * inner * b.transpose();
}

/// Takes out of the linearisation all that it says of the direction u of the states at `row`, the direct and the
/// crosswise: A - A u u^T A / u^T A u, the information of an experiment in which u is unknown.
void forget(Linearisation& scan, int row, const Eigen::Vector3d& u) {
  const MeasuredVector a_u = scan.information.middleCols<3>(row) * u;
  const double u_a_u = a_u.segment<3>(row).dot(u);
  if (u_a_u < 1e-12) return;
  const double u_b = u.dot(scan.gradient.segment<3>(row));
  scan.information -= a_u * a_u.transpose() / u_a_u;
  scan.gradient -= a_u * (u_b / u_a_u);
}

/// Finds the directions at `row` that the scan does not constrain, and forgets them.
/// noise: information that noise in the normals fakes; total: sum over all directions.
FreeDirections free_directions(const IeskfConfig& config, Linearisation& scan, int row, int other, double noise) {
  FreeDirections out;
  const double total = scan.information.block<3, 3>(row, row).trace();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(marginal(scan.information, row, other));
  const double least = std::max(config.degenerate_noise_ratio * noise, config.degenerate_share * total);
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] >= least) break;
    const Eigen::Vector3d u = solver.eigenvectors().col(i);
    forget(scan, row, u);
    if (out.count++ == 0) out.weakest = u;
  }
  return out;
}

struct Step {
  ErrorVector error;
  ErrorCovariance covariance;
};

/// Minimum of |state [+] e [-] prior|_P^2 + |r + H e|^2 with A = H^T R^-1 H, b = H^T R^-1 r.
Step solve(const Linearisation& scan, double scale, const ErrorVector& from_prior, const ErrorCovariance& prior) {
  // Prior in the tangent space of the present iterate, eq. (15).
  const ErrorCovariance j_inverse = boxminus_jacobian(from_prior).inverse();
  const ErrorCovariance p = j_inverse * prior * j_inverse.transpose();
  const ErrorVector d = j_inverse * from_prior;
  const MeasuredMatrix a = scale * scan.information;
  const MeasuredVector b = scale * scan.gradient;
  const auto p_m = p.leftCols<I::kMeasured>();
  const MeasuredMatrix inner = MeasuredMatrix::Identity() + a * p.topLeftCorner<I::kMeasured, I::kMeasured>();
  const Eigen::PartialPivLU<MeasuredMatrix> lu(inner);
  Step step;
  step.error = -d - p_m * lu.solve(b - a * d.head<I::kMeasured>());
  step.covariance = p - p_m * lu.solve(a * p_m.transpose());
  symmetrise(step.covariance);
  return step;
}

double position_sigma(const ErrorCovariance& p) {
  return std::sqrt(p.block<3, 3>(I::kPosition, I::kPosition).trace());
}

Matrix6d inverse_or_huge(const Matrix6d& information) {
  constexpr double kNoInformation = 1e-6;
  return (information + kNoInformation * Matrix6d::Identity()).inverse();
}

}  // namespace

double information_share(const IeskfConfig& config, std::uint32_t map_viewpoints) {
  const double age = std::min(1.0, static_cast<double>(map_viewpoints) / config.mature_viewpoints);
  return config.information_scale * age * age;
}

UpdateSummary update(const IeskfConfig& config, std::span<const MeasuredPoint> points, PointToPlane& residuals,
                     PlaneMap& map, FilterSnapshot& filter, StageListener* listener) {
  UpdateSummary summary;
  const InertialState prior = filter.state;
  InertialState state = prior;
  InertialState associated_at = prior;
  const double share = information_share(config, map.viewpoints());
  Step step{ErrorVector::Zero(), filter.covariance};
  const bool sure = position_sigma(filter.covariance) < config.associate_again_m;
  const std::uint32_t max_iterations = sure ? config.max_iterations : config.max_iterations_unsure;
  bool converged = false;
  for (std::uint32_t i = 0; i < max_iterations && !converged; ++i) {
    const double moved = (state.p_odom_imu - associated_at.p_odom_imu).norm();
    if (i == 0 || !sure || moved > config.associate_again_m) {
      residuals.associate(points, state, map);
      associated_at = state;
      if (listener != nullptr) listener->finished(Stage::kAssociate);
    }
    // The gate closes as the iterates settle: what the last step still moved is what remains unsure.
    const ErrorCovariance gate_covariance = step.covariance + step.error * step.error.transpose();
    Linearisation scan = residuals.linearise(state, gate_covariance, config.estimate_extrinsic);
    summary.iterations = i + 1;
    summary.matched = scan.matched;
    summary.inliers = scan.inliers;
    if (scan.inliers < config.min_inliers || scan.inliers < config.min_inlier_share * scan.matched) return summary;
    const FreeDirections positions =
        free_directions(config, scan, I::kPosition, I::kAttitude, scan.normal_noise);
    const FreeDirections attitudes =
        free_directions(config, scan, I::kAttitude, I::kPosition, scan.normal_noise_rotation);
    step = solve(scan, share, boxminus(state, prior), filter.covariance);
    if (!step.error.allFinite()) return summary;
    state = boxplus(state, step.error);
    converged = step.error.segment<3>(I::kPosition).norm() < config.converged_translation_m &&
                step.error.segment<3>(I::kAttitude).norm() < config.converged_rotation_rad;
    summary.free_translations = positions.count;
    summary.free_rotations = attitudes.count;
    summary.free_direction = positions.weakest;
    summary.test_ratio = scan.squared_error / scan.inliers;
    const MeasuredMatrix information = share * scan.information;
    summary.registration_covariance = inverse_or_huge(information.topLeftCorner<6, 6>());
  }
  filter.state = state;
  filter.covariance = step.covariance;
  summary.fused = true;
  return summary;
}

}  // namespace slamd
