// Reading of trajectory files: what is taken and how bad lines are refused.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

Trajectory tum(const std::string& text) {
  std::istringstream in(text);
  return read_tum(in, "est.tum");
}

Trajectory kitti(const std::string& text) {
  std::istringstream in(text);
  return read_kitti(in, "est.txt");
}

template <class Read>
std::string refusal(Read read, const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TumReader, takes_comments_blanks_commas_and_windows_line_ends) {
  const Trajectory t = tum("# stamp x y z\n\n1.5 1 2 3 0 0 0 1\r\n+2.5,4,5,6,0,0,2,0 # trailing\n");
  ASSERT_EQ(t.poses.size(), 2U);
  EXPECT_DOUBLE_EQ(t.stamps_s[0], 1.5);
  EXPECT_DOUBLE_EQ(t.stamps_s[1], 2.5);
  EXPECT_EQ(t.poses[1].translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(t.poses[1].rotation.norm(), 1.0, 1e-15);
  EXPECT_NEAR(t.poses[1].rotation.z(), 1.0, 1e-15);
}

TEST(TumReader, names_file_line_and_reason_of_a_bad_line) {
  EXPECT_EQ(refusal(tum, "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n"), "est.tum:2: expected 8 columns, found 7");
  EXPECT_EQ(refusal(tum, "1 0 0 0 0 0 0 1 9\n"), "est.tum:1: expected 8 columns, found 9");
  EXPECT_EQ(refusal(tum, "\n1 0 0 x 0 0 0 1\n"), "est.tum:2: 'x' is not a finite number");
  EXPECT_EQ(refusal(tum, "1 0 nan 0 0 0 0 1\n"), "est.tum:1: 'nan' is not a finite number");
  EXPECT_EQ(refusal(tum, "1 0 0 0 0 0 0 1e999\n"), "est.tum:1: '1e999' is not a finite number");
  EXPECT_EQ(refusal(tum, "1 0 0 0 0 0 0 1.0f\n"), "est.tum:1: '1.0f' is not a finite number");
  EXPECT_EQ(refusal(tum, "1 0 0 0 0 0 0 0\n"), "est.tum:1: the quaternion is zero");
}

TEST(KittiReader, reads_a_row_major_matrix) {
  const Trajectory t = kitti("0 -1 0 7 1 0 0 8 0 0 1 9\n");
  ASSERT_EQ(t.poses.size(), 1U);
  EXPECT_FALSE(t.has_stamps());
  EXPECT_TRUE((t.poses[0] * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(7, 9, 9), 1e-12));
}

TEST(KittiReader, refuses_what_is_no_rotation) {
  EXPECT_EQ(refusal(kitti, "2 0 0 0 0 2 0 0 0 0 2 0\n"), "est.txt:1: the left 3x3 block is not a rotation");
  EXPECT_EQ(refusal(kitti, "1 0 0 0 0 1 0 0 0 0 -1 0\n"), "est.txt:1: the left 3x3 block is not a rotation");
}

class TrajectoryFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".txt");
  }
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }

  std::filesystem::path path_;
};

TEST_F(TrajectoryFile, format_is_told_by_the_number_of_columns) {
  write("# comment\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(guess_format(path_), TrajectoryFormat::kKitti);
  write("1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(guess_format(path_), TrajectoryFormat::kTum);
}

TEST_F(TrajectoryFile, that_is_absent_or_empty_is_refused_with_its_path) {
  const auto load = [](const std::string& path) { return load_trajectory(path, TrajectoryFormat::kTum); };
  EXPECT_EQ(refusal(load, path_.string()), path_.string() + ": cannot be opened for reading");
  EXPECT_EQ(refusal(load, testing::TempDir()), testing::TempDir() + ": cannot be opened for reading");
  write("# nothing\n");
  EXPECT_EQ(refusal(load, path_.string()), path_.string() + ": holds no pose");
}

}  // namespace
}  // namespace slamd::eval
