#include "tools/slam-eval/relations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>
#include <sstream>

namespace slamd::eval {
namespace {

std::optional<Relation> parse(const std::string& line) {
  std::istringstream in{line};
  std::array<double, 8> n;
  for (double& value : n) {
    if (!(in >> value) || !std::isfinite(value)) return std::nullopt;
  }
  std::string rest;
  if (in >> rest) return std::nullopt;
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd{n[7], Eigen::Vector3d::UnitZ()} * Eigen::AngleAxisd{n[6], Eigen::Vector3d::UnitY()} *
                                      Eigen::AngleAxisd{n[5], Eigen::Vector3d::UnitX()};
  return Relation{n[0], n[1], {rotation, {n[2], n[3], n[4]}}};
}

/// Poses by time, whatever their order in the file.
class PoseByTime {
 public:
  PoseByTime(const Trajectory& trajectory, double max_diff_s) : trajectory_{trajectory}, max_diff_s_{max_diff_s} {
    order_.resize(trajectory.poses.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return trajectory.stamps_s[i]; });
  }

  const Pose* at(double time_s) const {
    const auto stamp = [this](std::size_t i) { return trajectory_.stamps_s[i]; };
    auto nearest = std::ranges::lower_bound(order_, time_s, {}, stamp);
    if (nearest == order_.end() || (nearest != order_.begin() && time_s - stamp(*std::prev(nearest)) <= stamp(*nearest) - time_s)) {
      if (nearest == order_.begin()) return nullptr;
      --nearest;
    }
    return std::abs(stamp(*nearest) - time_s) <= max_diff_s_ ? &trajectory_.poses[*nearest] : nullptr;
  }

 private:
  const Trajectory& trajectory_;
  double max_diff_s_;
  std::vector<std::size_t> order_;
};

}  // namespace

std::vector<Relation> load_relations(const std::filesystem::path& path) {
  std::ifstream in{path};
  if (!in) throw InputError(path.string() + ": cannot be opened");
  std::vector<Relation> relations;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    const std::optional<Relation> relation = parse(line);
    if (!relation) throw InputError(path.string() + ":" + std::to_string(number) + ": not eight numbers: from to x y z roll pitch yaw");
    relations.push_back(*relation);
  }
  if (relations.empty()) throw InputError(path.string() + ": holds no relation");
  return relations;
}

RelationErrors errors_by_relations(const std::vector<Relation>& relations, const Trajectory& estimate, double max_diff_s) {
  if (!estimate.has_stamps()) throw InputError("the estimate has no stamps: relations need a TUM file");
  const PoseByTime poses{estimate, max_diff_s};
  RelationErrors errors;
  for (const Relation& relation : relations) {
    const Pose* from = poses.at(relation.from_s);
    const Pose* to = poses.at(relation.to_s);
    if (from == nullptr || to == nullptr) {
      ++errors.without_pose;
      continue;
    }
    const Pose error = relation.T_from_to.inverse() * (from->inverse() * *to);
    errors.translation_m.push_back(error.translation.norm());
    errors.angle_rad.push_back(Eigen::AngleAxisd{error.rotation}.angle());
  }
  return errors;
}

}  // namespace slamd::eval
