#include "estimator/filter/ieskf.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <optional>

namespace slamd {

using I = ErrorIndex;

namespace {

struct FreeDirections {
  int count = 0;
  Eigen::Vector3d weakest = Eigen::Vector3d::Zero();
};

/// Information on the three states at `row` with the three at `other` marginalised out (Schur complement). The noise of
/// those keeps their block positive.
Eigen::Matrix3d marginal(const MeasuredMatrix& a, int row, int other, double noise_other) {
  const Eigen::Matrix3d b = a.block<3, 3>(row, other);
  const Eigen::Matrix3d c = a.block<3, 3>(other, other);
  const double damping = noise_other + 1e-9 * c.trace() + 1e-12;
  const Eigen::Matrix3d inner = (c + damping * Eigen::Matrix3d::Identity()).inverse();
  return a.block<3, 3>(row, row) - b * inner * b.transpose();
}

/// Takes out of the linearisation all that it says of the direction u of the states at `row`. Where u has information of
/// its own (above `least`) but only together with other states, what it says of those is kept: A - A u u^T A / u^T A u, an
/// experiment in which u is unknown. Otherwise its cross terms are noise too, and go.
void forget(Linearisation& scan, int row, const Eigen::Vector3d& u, double least) {
  const MeasuredVector a_u = scan.information.middleCols<3>(row) * u;
  const double u_a_u = a_u.segment<3>(row).dot(u);
  const double u_b = u.dot(scan.gradient.segment<3>(row));
  if (u_a_u > 4.0 * least) {
    scan.information -= a_u * a_u.transpose() / u_a_u;
    scan.gradient -= a_u * (u_b / u_a_u);
    return;
  }
  scan.information.middleCols<3>(row) -= a_u * u.transpose();
  scan.information.middleRows<3>(row) -= u * (u.transpose() * scan.information.middleRows<3>(row)).eval();
  scan.gradient.segment<3>(row) -= u_b * u;
}

/// Finds the directions at `row` that the scan does not constrain, and forgets them.
/// noise: information that noise in the normals fakes; total: sum over all directions.
FreeDirections free_directions(const IeskfConfig& config, Linearisation& scan, int row, int other, double noise,
                               double noise_other) {
  FreeDirections out;
  const double total = scan.information.block<3, 3>(row, row).trace();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(marginal(scan.information, row, other, noise_other));
  const double least = std::max(config.degenerate_noise_ratio * noise, config.degenerate_share * total);
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] >= least) break;
    const Eigen::Vector3d u = solver.eigenvectors().col(i);
    forget(scan, row, u, least);
    if (out.count++ == 0) out.weakest = u;
  }
  return out;
}

/// The prior's covariance and mean in the tangent space of one iterate, eq. (15).
struct TangentPrior {
  ErrorCovariance covariance;
  CloneCovariance cross;
  ErrorVector mean;  // prior [-] iterate, to first order
};

TangentPrior tangent_prior(const FilterSnapshot& prior, const ErrorVector& from_prior) {
  TangentPrior out{prior.covariance, prior.clone.cross, -from_prior};
  for (const int row : {I::kAttitude, I::kExtrinsicRotation}) {
    const Eigen::Vector3d angle = from_prior.segment<3>(row);
    const Eigen::Matrix3d J = right_jacobian_so3(angle);  // inverse of boxminus_jacobian's block
    out.covariance.middleRows<3>(row) = (J * out.covariance.middleRows<3>(row)).eval();
    out.covariance.middleCols<3>(row) = (out.covariance.middleCols<3>(row) * J.transpose()).eval();
    out.cross.middleRows<3>(row) = (J * out.cross.middleRows<3>(row)).eval();
    out.mean.segment<3>(row) = -J * angle;
  }
  return out;
}

/// Minimum of |iterate [+] e [-] prior|_P^2 + |r + H e|^2 with A = H^T R^-1 H, b = H^T R^-1 r.
class Step {
 public:
  Step(const Linearisation& scan, double share, const FilterSnapshot& prior, const ErrorVector& from_prior)
      : prior_{tangent_prior(prior, from_prior)} {
    const MeasuredMatrix a = share * scan.information;
    const MeasuredVector b = share * scan.gradient;
    const auto p_m = prior_.covariance.leftCols<I::kMeasured>();
    const MeasuredMatrix inner = MeasuredMatrix::Identity() + a * p_m.topRows<I::kMeasured>();
    const Eigen::PartialPivLU<MeasuredMatrix> lu(inner);
    error_ = prior_.mean - p_m * lu.solve(b + a * prior_.mean.head<I::kMeasured>());
    corrected_ = p_m * lu.solve(a);
  }

  const ErrorVector& error() const { return error_; }
  /// Of attitude and position: all that the gates of the next iteration need.
  Matrix6d pose_covariance() const {
    return prior_.covariance.topLeftCorner<6, 6>() -
           corrected_.topRows<6>() * prior_.covariance.topLeftCorner<I::kMeasured, 6>();
  }
  /// (I - K H) P and (I - K H) X.
  void finish(FilterSnapshot& filter) const {
    filter.covariance = prior_.covariance - corrected_ * prior_.covariance.topRows<I::kMeasured>();
    filter.clone.cross = prior_.cross - corrected_ * prior_.cross.topRows<I::kMeasured>();
    symmetrise(filter.covariance);
  }

 private:
  TangentPrior prior_;
  ErrorVector error_;
  Eigen::Matrix<double, I::kSize, I::kMeasured> corrected_;  // K H, its columns of the measured states
};

/// |correction|^2 of the three states at `row` in the prior's covariance.
double in_prior_sigmas(const FilterSnapshot& prior, const ErrorVector& correction, int row) {
  const Eigen::Matrix3d covariance = prior.covariance.block<3, 3>(row, row);
  return correction.segment<3>(row).dot(covariance.ldlt().solve(correction.segment<3>(row)));
}

double position_sigma(const ErrorCovariance& p) {
  return std::sqrt(p.block<3, 3>(I::kPosition, I::kPosition).trace());
}

bool has_converged(const IeskfConfig& config, const ErrorVector& error) {
  return error.segment<3>(I::kPosition).norm() < config.converged_translation_m &&
         error.segment<3>(I::kAttitude).norm() < config.converged_rotation_rad;
}

bool is_enough(const IeskfConfig& config, const Linearisation& scan) {
  return scan.inliers >= config.min_inliers && scan.inliers >= config.min_inlier_share * scan.matched;
}

void forget_free_directions(const IeskfConfig& config, Linearisation& scan, UpdateSummary& summary) {
  const double noise = scan.normal_noise;
  const double noise_rotation = scan.normal_noise_rotation;
  const FreeDirections positions = free_directions(config, scan, I::kPosition, I::kAttitude, noise, noise_rotation);
  const FreeDirections attitudes = free_directions(config, scan, I::kAttitude, I::kPosition, noise_rotation, noise);
  summary.free_translations = positions.count;
  summary.free_rotations = attitudes.count;
  summary.free_direction = positions.weakest;
}

/// The share of the scan's information that is believed. A free direction is known to an angle of its own, by which the
/// information on the others leaks into it, scan by scan: while one is free the others are told to a centimetre, not to a
/// millimetre. Likewise all of a scan that an unsure velocity has skewed.
double believed(const IeskfConfig& config, const Linearisation& scan, const UpdateSummary& summary) {
  double sigma_m = config.least_sigma_m;
  if (!summary.sure) sigma_m = std::max(sigma_m, config.unsure_sigma_m);
  if (summary.free_translations > 0) sigma_m = std::max(sigma_m, config.degenerate_sigma_m);
  if (sigma_m == 0.0) return config.information_scale;
  const double most = 1.0 / (sigma_m * sigma_m);
  return std::min(config.information_scale, most / scan.information.block<3, 3>(I::kPosition, I::kPosition).trace());
}

}  // namespace

UpdateSummary update(const IeskfConfig& config, std::span<const MeasuredPoint> points, PointToPlane& residuals,
                     PlaneMap& map, FilterSnapshot& filter, StageListener* listener) {
  UpdateSummary summary;
  InertialState state = filter.state;
  InertialState associated_at = state;
  Matrix6d gate_covariance = filter.covariance.topLeftCorner<6, 6>();
  summary.sure = position_sigma(filter.covariance) < config.associate_again_m;
  const std::uint32_t most = summary.sure ? config.max_iterations : config.max_iterations_unsure;
  std::optional<Step> step;
  while (summary.iterations < most && !(step && has_converged(config, step->error()))) {
    const double moved = (state.p_odom_imu - associated_at.p_odom_imu).norm();
    if (!step || !summary.sure || moved > config.associate_again_m) {
      residuals.associate(points, state, map);
      associated_at = state;
      if (listener != nullptr) listener->finished(Stage::kAssociate);
    }
    Linearisation scan = residuals.linearise(state, gate_covariance, config.estimate_extrinsic);
    ++summary.iterations;
    summary.matched = scan.matched;
    summary.inliers = scan.inliers;
    if (!is_enough(config, scan)) return summary;
    summary.test_ratio = scan.squared_error / scan.matched;
    forget_free_directions(config, scan, summary);
    step.emplace(scan, believed(config, scan, summary), filter, boxminus(state, filter.state));
    if (!step->error().allFinite()) return summary;
    state = boxplus(state, step->error());
    // The gate closes as the iterates settle: what the last step still moved is what remains unsure.
    const auto moved_now = step->error().head<6>();
    gate_covariance = step->pose_covariance() + moved_now * moved_now.transpose();
  }
  if (step) {
    const ErrorVector correction = boxminus(state, filter.state);
    summary.attitude_correction = in_prior_sigmas(filter, correction, I::kAttitude);
    summary.position_correction = in_prior_sigmas(filter, correction, I::kPosition);
    step->finish(filter);
  }
  summary.corrected_mps = state.v_odom_imu - filter.state.v_odom_imu;
  filter.state = state;
  summary.fused = step.has_value();
  return summary;
}

}  // namespace slamd
