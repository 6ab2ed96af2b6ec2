#include "estimator/graph/chordal.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"

namespace slamd {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Dense = Eigen::MatrixXd;
constexpr std::size_t kKnown = static_cast<std::size_t>(-1);

/// Columns of the linear problems: the unknown poses, numbered from 0.
template <class Group>
std::vector<std::size_t> number_unknowns(const PoseGraph<Group>& graph, std::size_t& count) {
  std::vector<std::size_t> columns(graph.poses.size(), kKnown);
  count = 0;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    if (!graph.fixed[i]) columns[i] = count++;
  }
  return columns;
}

/// Least squares min sum w ||x_to - M^T x_from - c||^2 over blocks x (size rows, d columns each) as normal equations.
class Laplacian {
 public:
  Laplacian(std::size_t unknowns, int size, int columns)
      : size_{size}, rhs_{Dense::Zero(static_cast<Eigen::Index>(unknowns) * size, columns)} {}

  /// x_a^T H x_b += block
  void add(std::size_t a, std::size_t b, const Dense& block) {
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j < size_; ++j) {
        if (block(i, j) != 0.0) entries_.emplace_back(row(a) + i, row(b) + j, block(i, j));
      }
    }
  }
  void add_rhs(std::size_t a, const Dense& block) { rhs_.middleRows(row(a), size_) += block; }

  /// The solution, blocks stacked; nullopt when the matrix is singular.
  std::optional<Dense> solve() const {
    if (rhs_.rows() == 0) return rhs_;
    Sparse H{rhs_.rows(), rhs_.rows()};
    H.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Sparse> factorisation{H};
    if (factorisation.info() != Eigen::Success || factorisation.vectorD().minCoeff() <= 0.0) return std::nullopt;
    return factorisation.solve(rhs_);
  }

 private:
  int row(std::size_t column) const { return static_cast<int>(column) * size_; }

  int size_;
  std::vector<Eigen::Triplet<double>> entries_;
  Dense rhs_;
};

double weight_of(const std::vector<double>& weights, std::size_t edge) { return weights.empty() ? 1.0 : weights[edge]; }

/// n / tr(block^-1): as an isotropic one; 0 where nothing is known of some direction.
template <class Block>
double isotropic(const Block& block) {
  const double weight = static_cast<double>(block.rows()) / block.inverse().trace();
  return std::isfinite(weight) && weight > 0.0 ? weight : 0.0;
}

/// One an edge. What says nothing of some direction counts next to nothing rather than nothing: it may be all that there is.
template <class Group, class Weight>
std::vector<double> edge_weights(const PoseGraph<Group>& graph, const std::vector<double>& weights, const Weight& weight) {
  constexpr double kNextToNothing = 1e-9;
  std::vector<double> out;
  for (const Edge<Group>& edge : graph.edges) out.push_back(weight(edge.information));
  const double most = out.empty() ? 0.0 : *std::ranges::max_element(out);
  const double least = most > 0.0 ? kNextToNothing * most : 1.0;
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = weight_of(weights, k) * (out[k] > 0.0 ? out[k] : least);
  return out;
}

/// Rotations, transposed: R_to^T = R_from_to^T R_from^T, a linear equation in blocks of d rows.
template <class Group>
std::optional<Dense> solve_rotations(const PoseGraph<Group>& graph, const std::vector<double>& weights,
                                     const std::vector<std::size_t>& columns, std::size_t unknowns) {
  constexpr int d = Group::kDimension;
  Laplacian problem{unknowns, d, d};
  const std::vector<double> edge_weight = edge_weights(graph, weights, rotation_weight<Group>);
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const Edge<Group>& edge = graph.edges[k];
    const double w = edge_weight[k];
    const std::size_t a = columns[edge.from];
    const std::size_t b = columns[edge.to];
    const Dense wR = w * Group::rotation(edge.measured);
    if (a != kKnown) problem.add(a, a, w * Dense::Identity(d, d));
    if (b != kKnown) problem.add(b, b, w * Dense::Identity(d, d));
    if (a != kKnown && b != kKnown) {
      problem.add(a, b, -wR);
      problem.add(b, a, -wR.transpose());
    }
    if (a == kKnown && b != kKnown) {
      problem.add_rhs(b, wR.transpose() * Group::rotation(graph.poses[edge.from]).transpose());
    }
    if (a != kKnown && b == kKnown) problem.add_rhs(a, wR * Group::rotation(graph.poses[edge.to]).transpose());
  }
  return problem.solve();
}

/// Translations with known rotations: t_to - t_from = R_from t_from_to, one row a pose, d columns.
template <class Group>
std::optional<Dense> solve_translations(const PoseGraph<Group>& graph, const std::vector<double>& weights,
                                        const std::vector<std::size_t>& columns, std::size_t unknowns) {
  Laplacian problem{unknowns, 1, Group::kDimension};
  const Dense one = Dense::Identity(1, 1);
  const std::vector<double> edge_weight = edge_weights(graph, weights, translation_weight<Group>);
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const Edge<Group>& edge = graph.edges[k];
    const double w = edge_weight[k];
    const std::size_t a = columns[edge.from];
    const std::size_t b = columns[edge.to];
    const auto& T_from = graph.poses[edge.from];
    const Dense step = w * (Group::rotation(T_from) * Group::translation(edge.measured)).transpose();
    if (a != kKnown) {
      problem.add(a, a, w * one);
      problem.add_rhs(a, -step);
      if (b == kKnown) problem.add_rhs(a, w * Group::translation(graph.poses[edge.to]).transpose());
    }
    if (b != kKnown) {
      problem.add(b, b, w * one);
      problem.add_rhs(b, step);
      if (a == kKnown) problem.add_rhs(b, w * Group::translation(T_from).transpose());
    }
    if (a != kKnown && b != kKnown) {
      problem.add(a, b, -w * one);
      problem.add(b, a, -w * one);
    }
  }
  return problem.solve();
}

}  // namespace

template <class Group>
double translation_weight(const typename Group::Matrix& information) {
  constexpr int d = Group::kDimension;
  return isotropic(Eigen::Matrix<double, d, d>{information.template topLeftCorner<d, d>()});
}

template <class Group>
double rotation_weight(const typename Group::Matrix& information) {
  constexpr int n = Group::kDof - Group::kDimension;
  return isotropic(Eigen::Matrix<double, n, n>{information.template bottomRightCorner<n, n>()});
}

template <class Group>
bool initialise_chordal(PoseGraph<Group>& graph, const std::vector<double>& weights) {
  constexpr int d = Group::kDimension;
  std::size_t unknowns = 0;
  const std::vector<std::size_t> columns = number_unknowns(graph, unknowns);
  const std::optional<Dense> rotations = solve_rotations(graph, weights, columns, unknowns);
  if (!rotations) return false;
  PoseGraph<Group> turned = graph;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] == kKnown) continue;
    const Eigen::Matrix<double, d, d> R = rotations->middleRows<d>(static_cast<Eigen::Index>(columns[i]) * d).transpose();
    turned.poses[i] = Group::make(R, Group::translation(graph.poses[i]));
  }
  const std::optional<Dense> translations = solve_translations(turned, weights, columns, unknowns);
  if (!translations) return false;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] == kKnown) continue;
    turned.poses[i].translation = translations->row(static_cast<Eigen::Index>(columns[i])).transpose();
  }
  graph.poses = std::move(turned.poses);
  return true;
}

template bool initialise_chordal(PoseGraph<GroupSe2>&, const std::vector<double>&);
template bool initialise_chordal(PoseGraph<GroupSe3>&, const std::vector<double>&);
template double translation_weight<GroupSe2>(const GroupSe2::Matrix&);
template double translation_weight<GroupSe3>(const GroupSe3::Matrix&);
template double rotation_weight<GroupSe2>(const GroupSe2::Matrix&);
template double rotation_weight<GroupSe3>(const GroupSe3::Matrix&);

}  // namespace slamd
