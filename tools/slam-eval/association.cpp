#include "tools/slam-eval/association.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

namespace slamd::eval {
namespace {

// Stamps in rising order with their place in the file.
class StampIndex {
 public:
  explicit StampIndex(const std::vector<double>& stamps_s) {
    for (std::size_t i = 0; i < stamps_s.size(); ++i) sorted_.emplace_back(stamps_s[i], i);
    std::sort(sorted_.begin(), sorted_.end());
  }

  // Place of the stamp nearest to t_s, the lowest place on a tie; none when all are further than max_diff_s.
  std::optional<std::size_t> nearest(double t_s, double max_diff_s) const {
    auto best = std::pair{max_diff_s, sorted_.size()};
    const auto offer = [&](const Entry& e) { best = std::min(best, {std::abs(e.first - t_s), e.second}); };
    const auto after = first_at(t_s);
    if (after != sorted_.end()) offer(*after);
    if (after != sorted_.begin()) offer(*first_at(std::prev(after)->first));
    if (best.second == sorted_.size()) return std::nullopt;
    return best.second;
  }

  // Places of the stamps around t_s: the last one at or before it, the first one at or after it.
  std::optional<std::pair<std::size_t, std::size_t>> around(double t_s) const {
    const auto after = first_at(t_s);
    if (after == sorted_.end()) return std::nullopt;
    if (after->first == t_s) return std::pair{after->second, after->second};
    if (after == sorted_.begin()) return std::nullopt;
    return std::pair{std::prev(after)->second, after->second};
  }

  double begin_s() const { return sorted_.front().first; }
  double end_s() const { return sorted_.back().first; }

 private:
  using Entry = std::pair<double, std::size_t>;

  std::vector<Entry>::const_iterator first_at(double t_s) const {
    return std::lower_bound(sorted_.begin(), sorted_.end(), Entry{t_s, 0});
  }

  std::vector<Entry> sorted_;
};

std::string seconds(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.3f", value);
  return text;
}

[[noreturn]] void fail_without_overlap(const StampIndex& truth, const StampIndex& estimate, const AssociationOptions& o) {
  std::string text = "no pose of the estimate belongs to a pose of the truth: the truth spans " +
                     seconds(truth.begin_s()) + " .. " + seconds(truth.end_s()) + " s, the estimate " +
                     seconds(estimate.begin_s()) + " .. " + seconds(estimate.end_s()) + " s. ";
  if (estimate.begin_s() > truth.end_s() || estimate.end_s() < truth.begin_s()) {
    text += "They do not overlap. If they show the same drive on two clocks, shift the estimate with --time-offset " +
            seconds(truth.begin_s() - estimate.begin_s() + o.time_offset_s) +
            " (that makes their first stamps equal); if not, this is the wrong pair of files.";
  } else if (o.interpolate) {
    text += "They overlap, but the truth has no two poses within " + seconds(o.max_gap_s) + " s around any stamp.";
  } else {
    text += "They overlap, but no two stamps are within --max-diff " + seconds(o.max_diff_s) +
            " s. Compare with interpolated truth (--interpolate) or allow more with --max-diff.";
  }
  throw InputError(text);
}

std::vector<double> shifted(std::vector<double> stamps_s, double offset_s) {
  for (double& t : stamps_s) t += offset_s;
  return stamps_s;
}

MatchedPoses by_index(const Trajectory& truth, const Trajectory& estimate) {
  if (truth.poses.size() != estimate.poses.size()) {
    throw InputError("without stamps the trajectories must have the same number of poses: the truth has " +
                     std::to_string(truth.poses.size()) + ", the estimate " + std::to_string(estimate.poses.size()));
  }
  return {{}, truth.poses, estimate.poses};
}

void by_nearest_stamp(const Trajectory& truth, const Trajectory& estimate, const std::vector<double>& estimate_s,
                      double max_diff_s, MatchedPoses& matched) {
  const bool estimate_longer = estimate_s.size() > truth.stamps_s.size();
  const StampIndex longer(estimate_longer ? estimate_s : truth.stamps_s);
  const std::vector<double>& shorter_s = estimate_longer ? truth.stamps_s : estimate_s;
  for (std::size_t i = 0; i < shorter_s.size(); ++i) {
    const auto j = longer.nearest(shorter_s[i], max_diff_s);
    if (!j) continue;
    const std::size_t e = estimate_longer ? *j : i;
    matched.stamps_s.push_back(estimate_s[e]);
    matched.truth.push_back(truth.poses[estimate_longer ? i : *j]);
    matched.estimate.push_back(estimate.poses[e]);
  }
}

Pose between(const Pose& a, const Pose& b, double share) {
  return {a.rotation.slerp(share, b.rotation), (1.0 - share) * a.translation + share * b.translation};
}

void by_interpolation(const Trajectory& truth, const Trajectory& estimate, const std::vector<double>& estimate_s,
                      double max_gap_s, MatchedPoses& matched) {
  const StampIndex index(truth.stamps_s);
  for (std::size_t i = 0; i < estimate_s.size(); ++i) {
    const auto places = index.around(estimate_s[i]);
    if (!places) continue;
    const auto [a, b] = *places;
    const double gap_s = truth.stamps_s[b] - truth.stamps_s[a];
    if (gap_s > max_gap_s) continue;
    const double share = gap_s > 0.0 ? (estimate_s[i] - truth.stamps_s[a]) / gap_s : 0.0;
    matched.stamps_s.push_back(estimate_s[i]);
    matched.truth.push_back(between(truth.poses[a], truth.poses[b], share));
    matched.estimate.push_back(estimate.poses[i]);
  }
}

}  // namespace

MatchedPoses associate(const Trajectory& truth, const Trajectory& estimate, const AssociationOptions& options) {
  if (truth.has_stamps() != estimate.has_stamps()) {
    throw InputError("one trajectory has stamps (TUM) and the other has none (KITTI): give both in one format");
  }
  if (!truth.has_stamps()) return by_index(truth, estimate);
  const std::vector<double> estimate_s = shifted(estimate.stamps_s, options.time_offset_s);
  MatchedPoses matched;
  if (options.interpolate) {
    by_interpolation(truth, estimate, estimate_s, options.max_gap_s, matched);
  } else {
    by_nearest_stamp(truth, estimate, estimate_s, options.max_diff_s, matched);
  }
  if (matched.truth.empty()) fail_without_overlap(StampIndex(truth.stamps_s), StampIndex(estimate_s), options);
  return matched;
}

void project_to_plane(MatchedPoses& matched) {
  for (std::vector<Pose>* poses : {&matched.truth, &matched.estimate}) {
    for (Pose& pose : *poses) {
      const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
      pose.rotation = Eigen::AngleAxisd{std::atan2(ahead.y(), ahead.x()), Eigen::Vector3d::UnitZ()};
      pose.translation.z() = 0.0;
    }
  }
}

}  // namespace slamd::eval
