#pragma once
// The error of a trajectory by relations: poses of pairs of instants relative to each other, as measured by hand or by matching, where no
// trajectory is known that could be the truth. No alignment.
// Source: Kuemmerle et al. 2009, "On Measuring the Accuracy of SLAM Algorithms", eq. (3).

#include <filesystem>
#include <vector>

#include "tools/slam-eval/metrics.hpp"
#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {

struct Relation {
  double from_s = 0.0, to_s = 0.0;  // stamps
  Pose T_from_to;
};

/// Lines `from_s to_s x y z roll pitch yaw` (seconds, metres, radians). Throws InputError with file, line and reason.
std::vector<Relation> load_relations(const std::filesystem::path& path);

struct RelationErrors {
  std::vector<double> translation_m;  // one a relation that the trajectory has both ends of
  std::vector<double> angle_rad;
  std::size_t without_pose = 0;       // relations with an end that no pose is near
};

/// max_diff_s  between a relation's stamp and the pose that is taken for it, the nearest
RelationErrors errors_by_relations(const std::vector<Relation>& relations, const Trajectory& estimate, double max_diff_s);

}  // namespace slamd::eval
