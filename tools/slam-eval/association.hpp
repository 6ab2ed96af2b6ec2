#pragma once
// Which pose of the estimate is compared with which pose of the truth. No alignment, no metric.

#include <vector>

#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {

struct AssociationOptions {
  double max_diff_s = 0.01;    // largest distance of two stamps that belong together
  double time_offset_s = 0.0;  // added to the stamps of the estimate
  bool interpolate = false;    // compare with the truth interpolated to the estimate's stamps instead of the nearest
  double max_gap_s = 1.0;      // with interpolate: truth further apart than this is not bridged
};

/// Poses that belong together: truth[i] with estimate[i].
struct MatchedPoses {
  std::vector<double> stamps_s;  // of the estimate, offset added; empty without stamps
  std::vector<Pose> truth;
  std::vector<Pose> estimate;
};

/// Every pose of the shorter trajectory takes the nearest stamp of the longer one if it is within max_diff_s (on a tie
/// the earlier in the file; a pose of the longer one may be taken twice). Without stamps: by index, equal lengths.
/// Throws InputError with advice when nothing belongs together. Cost n log n.
/// Source: evo (Grupp 2017), sync.associate_trajectories; equality checked in tests/tools/eval_evo_test.cpp.
MatchedPoses associate(const Trajectory& truth, const Trajectory& estimate, const AssociationOptions& options);

/// What a planar estimate can be asked for: z is 0, and of the attitude the heading alone stays (of its x axis; turns of z leave it).
void project_to_plane(MatchedPoses& matched);

}  // namespace slamd::eval
