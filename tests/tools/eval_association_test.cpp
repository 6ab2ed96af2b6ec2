// Which poses are compared: nearest stamps, interpolation, and the advice when nothing fits.
#include <gtest/gtest.h>

#include "tools/slam-eval/association.hpp"

namespace slamd::eval {
namespace {

// Poses on the x axis, x = the place in the list.
Trajectory line(const std::vector<double>& stamps_s) {
  Trajectory t;
  t.stamps_s = stamps_s;
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    t.poses.push_back({Eigen::Quaterniond::Identity(), {static_cast<double>(i), 0.0, 0.0}});
  }
  return t;
}

std::vector<double> xs(const std::vector<Pose>& poses) {
  std::vector<double> x;
  for (const Pose& pose : poses) x.push_back(pose.translation.x());
  return x;
}

std::string refusal(const Trajectory& truth, const Trajectory& estimate, const AssociationOptions& options) {
  try {
    associate(truth, estimate, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Association, takes_the_nearest_stamp_within_the_limit_for_each_pose_of_the_shorter) {
  const auto m = associate(line({0.0, 0.1, 0.2, 0.3}), line({0.104, 0.296, 0.35}), {});
  EXPECT_EQ(xs(m.truth), (std::vector<double>{1, 3}));
  EXPECT_EQ(xs(m.estimate), (std::vector<double>{0, 1}));
  EXPECT_EQ(m.stamps_s, (std::vector<double>{0.104, 0.296}));
}

TEST(Association, may_take_a_pose_of_the_longer_trajectory_twice) {
  const auto m = associate(line({0.998, 1.002}), line({0.0, 1.0, 2.0}), {});
  EXPECT_EQ(xs(m.truth), (std::vector<double>{0, 1}));
  EXPECT_EQ(xs(m.estimate), (std::vector<double>{1, 1}));
}

TEST(Association, takes_the_earlier_in_the_file_on_a_tie_also_when_unsorted) {
  const auto m = associate(line({1.25, 0.75, 0.0}), line({1.0}), {.max_diff_s = 0.25});
  EXPECT_EQ(xs(m.truth), (std::vector<double>{0}));
  const auto repeated = associate(line({3.0, 1.0, 1.0}), line({1.0}), {});
  EXPECT_EQ(xs(repeated.truth), (std::vector<double>{1}));
}

TEST(Association, adds_the_offset_to_the_estimate) {
  const auto m = associate(line({100.0, 101.0}), line({0.0, 1.0}), {.time_offset_s = 100.0});
  EXPECT_EQ(xs(m.truth), (std::vector<double>{0, 1}));
  EXPECT_EQ(m.stamps_s, (std::vector<double>{100.0, 101.0}));
}

TEST(Association, without_stamps_goes_by_index_and_wants_equal_lengths) {
  Trajectory a = line({0, 1});
  Trajectory b = line({0, 1, 2});
  a.stamps_s.clear();
  EXPECT_NE(refusal(a, b, {}).find("one trajectory has stamps"), std::string::npos);
  b.stamps_s.clear();
  EXPECT_NE(refusal(a, b, {}).find("same number of poses: the truth has 2, the estimate 3"), std::string::npos);
  EXPECT_EQ(associate(a, a, {}).truth.size(), 2U);
}

TEST(Interpolation, lies_between_the_neighbouring_poses) {
  Trajectory truth = line({0.0, 1.0, 2.0});
  truth.poses[1].rotation = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ());
  const auto m = associate(truth, line({-0.5, 0.25, 1.0, 2.5}), {.interpolate = true});
  ASSERT_EQ(xs(m.truth), (std::vector<double>{0.25, 1.0}));
  EXPECT_NEAR(m.truth[0].rotation.angularDistance(Eigen::Quaterniond::Identity()), 0.2, 1e-12);
  EXPECT_EQ(xs(m.estimate), (std::vector<double>{1, 2}));
}

TEST(Interpolation, does_not_bridge_a_gap) {
  const auto m = associate(line({0.0, 0.5, 5.0}), line({0.25, 3.0, 5.0}), {.interpolate = true, .max_gap_s = 1.0});
  EXPECT_EQ(xs(m.estimate), (std::vector<double>{0, 2}));
}

TEST(NoOverlap, says_both_spans_and_the_offset_that_would_help) {
  const std::string text = refusal(line({1000.0, 1010.0}), line({0.5, 9.0}), {});
  EXPECT_NE(text.find("the truth spans 1000.000 .. 1010.000 s, the estimate 0.500 .. 9.000 s"), std::string::npos);
  EXPECT_NE(text.find("--time-offset 999.500"), std::string::npos);
}

TEST(NoOverlap, with_overlapping_spans_points_to_interpolation) {
  const std::string text = refusal(line({0.0, 1.0}), line({0.5}), {});
  EXPECT_NE(text.find("--interpolate"), std::string::npos);
  EXPECT_EQ(text.find("--time-offset"), std::string::npos);
}

TEST(InPlane, heading_and_place_stay_height_and_lean_go) {
  const Eigen::Quaterniond lean = Eigen::AngleAxisd{0.7, Eigen::Vector3d::UnitZ()} * Eigen::AngleAxisd{0.2, Eigen::Vector3d::UnitY()} *
                                  Eigen::Quaterniond{Eigen::AngleAxisd{-0.1, Eigen::Vector3d::UnitX()}};
  MatchedPoses matched{{}, {{lean, {1, 2, 3}}}, {{Eigen::Quaterniond::Identity(), {4, 5, -6}}}};
  project_to_plane(matched);
  EXPECT_EQ(matched.truth[0].translation, Eigen::Vector3d(1, 2, 0));
  EXPECT_NEAR(matched.truth[0].rotation.angularDistance(Eigen::Quaterniond{Eigen::AngleAxisd{0.7, Eigen::Vector3d::UnitZ()}}), 0.0, 1e-12);
  EXPECT_EQ(matched.estimate[0].translation, Eigen::Vector3d(4, 5, 0));
}

}  // namespace
}  // namespace slamd::eval
