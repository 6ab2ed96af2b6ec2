// Errors by relations: of a right trajectory none, of a bent one what it is bent by; stamps that step back; files that are none.
#include "tools/slam-eval/relations.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

Pose at(double x, double y, double yaw) {
  return {Eigen::Quaterniond{Eigen::AngleAxisd{yaw, Eigen::Vector3d::UnitZ()}}, {x, y, 0.0}};
}

class RelationsTest : public ::testing::Test {
 protected:
  ~RelationsTest() override { fs::remove(path_); }
  std::vector<Relation> load(const std::string& text) {
    std::ofstream{path_} << text;
    return load_relations(path_);
  }
  std::string refusal(const std::string& text) {
    try {
      load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path path_ = fs::path{testing::TempDir()} / ("slamd_relations_" + std::to_string(::getpid()));
};

TEST_F(RelationsTest, OfARightTrajectoryThereIsNoError) {
  const Trajectory truth{{10.0, 12.0, 11.0}, {at(1, 2, 0.3), at(4, 5, 2.0), at(2, 2, 1.0)}};
  const Pose first = truth.poses[0].inverse() * truth.poses[1];
  std::array<char, 200> line;
  std::snprintf(line.data(), line.size(), "10.004 11.997 %.9f %.9f 0 0 0 %.9f\n", first.translation.x(), first.translation.y(), 1.7);
  const RelationErrors errors = errors_by_relations(load("# by hand\n\n" + std::string{line.data()}), truth, 0.006);
  ASSERT_EQ(errors.translation_m.size(), 1U);
  EXPECT_NEAR(errors.translation_m[0], 0.0, 1e-6);
  EXPECT_NEAR(errors.angle_rad[0], 0.0, 1e-6);
}

TEST_F(RelationsTest, OfABentOneItIsWhatItIsBentByInTheFrameOfTheRelation) {
  const Trajectory bent{{0.0, 1.0}, {at(0, 0, 1.0), at(0, 1, 1.5)}};
  const RelationErrors errors = errors_by_relations(load("0 1 1 0 0 0 0 0\n"), bent, 0.01);
  const Pose right = at(1, 0, 0.0), said = bent.poses[0].inverse() * bent.poses[1];
  EXPECT_NEAR(errors.translation_m.at(0), (right.translation - said.translation).norm(), 1e-12);
  EXPECT_NEAR(errors.angle_rad.at(0), 0.5, 1e-12);
}

TEST_F(RelationsTest, ThoseWithoutAPoseAreCounted) {
  const Trajectory drive{{5.0, 6.0}, {at(0, 0, 0), at(1, 0, 0)}};
  const RelationErrors errors = errors_by_relations(load("5 6 1 0 0 0 0 0\n5 7 1 0 0 0 0 0\n0 6 1 0 0 0 0 0\n5.01 6 1 0 0 0 0 0"), drive, 0.005);
  EXPECT_EQ(errors.translation_m.size(), 1U);
  EXPECT_EQ(errors.without_pose, 3U);
}

TEST_F(RelationsTest, AFileThatIsNoneIsRefusedWithLineAndReason) {
  EXPECT_NE(refusal("0 1 1 0 0 0 0 0\n0 1 1 0 0 0 0\n").find(":2: not eight numbers"), std::string::npos);
  EXPECT_NE(refusal("0 1 1 0 0 0 0 0 9\n").find(":1:"), std::string::npos);
  EXPECT_NE(refusal("0 1 nan 0 0 0 0 0\n").find(":1:"), std::string::npos);
  EXPECT_NE(refusal("\n").find("holds no relation"), std::string::npos);
  EXPECT_THROW(load_relations("/nonexistent/relations"), InputError);
}

}  // namespace
}  // namespace slamd::eval
