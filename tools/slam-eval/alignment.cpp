#include "tools/slam-eval/alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <limits>

#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

Eigen::Matrix3Xd positions(const std::vector<Pose>& poses, std::size_t count) {
  Eigen::Matrix3Xd p(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) p.col(static_cast<Eigen::Index>(i)) = poses[i].translation;
  return p;
}

Similarity umeyama(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& estimate, bool with_scale) {
  const double n = static_cast<double>(truth.cols());
  const Eigen::Vector3d mean_truth = truth.rowwise().mean();
  const Eigen::Vector3d mean_estimate = estimate.rowwise().mean();
  const Eigen::Matrix3Xd centred_estimate = estimate.colwise() - mean_estimate;
  const Eigen::Matrix3d covariance = (truth.colwise() - mean_truth) * centred_estimate.transpose() / n;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()(1) <= std::numeric_limits<double>::epsilon()) {
    throw InputError(
        "the positions do not fix an alignment (too few poses, or no motion, or motion on one line): use --no-align or "
        "--align-origin");
  }
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double variance = centred_estimate.squaredNorm() / n;
  const double scale = with_scale ? svd.singularValues().dot(sign) / variance : 1.0;
  return {{Eigen::Quaterniond(rotation).normalized(), mean_truth - scale * rotation * mean_estimate}, scale};
}

}  // namespace

const char* name(Alignment alignment) {
  switch (alignment) {
    case Alignment::kNone: return "none";
    case Alignment::kSe3Umeyama: return "se3_umeyama";
    case Alignment::kSim3Umeyama: return "sim3_umeyama";
    case Alignment::kOrigin: return "origin";
  }
  return "none";
}

Similarity fit(Alignment alignment, const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
               std::size_t count) {
  if (alignment == Alignment::kNone || truth.empty()) return {};
  if (alignment == Alignment::kOrigin) return {truth.front() * estimate.front().inverse(), 1.0};
  const std::size_t used = count == 0 ? truth.size() : std::min(count, truth.size());
  return umeyama(positions(truth, used), positions(estimate, used), alignment == Alignment::kSim3Umeyama);
}

std::vector<Pose> aligned(const Similarity& similarity, const std::vector<Pose>& poses) {
  std::vector<Pose> moved;
  moved.reserve(poses.size());
  for (const Pose& pose : poses) {
    moved.push_back(similarity.T_truth_estimate * Pose{pose.rotation, similarity.scale * pose.translation});
  }
  return moved;
}

}  // namespace slamd::eval
