// The g2o reader and writer: what is read, what is refused and where.

#include "tools/slam-pgo/g2o_file.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace slamd::pgo {
namespace {

constexpr const char* kPlanar =
    "# a comment\n"
    "EDGE_SE2 7 3 1.5 -0.5 0.25 10 1 2 20 3 30\n"
    "\n"
    "VERTEX_SE2 7 1 2 0.5\r\n"
    "FIX 7\n"
    "VERTEX_SE2 3 +4 5e-1 -0.5\n";

constexpr const char* kSpatial =
    "VERTEX_SE3:QUAT 0 1 2 3 0 0 0 2e0\n"  // refused: norm 2 is no rotation
    "";

std::variant<AnyGraph, G2oFault> read(const std::string& text) {
  std::istringstream in{text};
  return read_g2o(in);
}

std::string written(const AnyGraph& any) {
  std::ostringstream out;
  write_g2o(out, any);
  return out.str();
}

void expect_fault(const std::string& text, std::size_t line, const std::string& reason) {
  const auto result = read(text);
  const auto* fault = std::get_if<G2oFault>(&result);
  ASSERT_NE(fault, nullptr) << text;
  EXPECT_EQ(fault->line, line) << text;
  EXPECT_NE(fault->reason.find(reason), std::string::npos) << fault->reason;
}

TEST(G2oFile, ReadsPosesInOrderOfTheirIdsWithEdgesAndFixes) {
  const auto result = read(kPlanar);
  ASSERT_TRUE(std::holds_alternative<AnyGraph>(result));
  const auto& g2o = std::get<G2oGraph<GroupSe2>>(std::get<AnyGraph>(result));
  EXPECT_EQ(g2o.ids, (std::vector<std::int64_t>{3, 7}));
  EXPECT_TRUE(g2o.complete);
  EXPECT_EQ(g2o.graph.fixed, (std::vector<bool>{false, true}));
  EXPECT_EQ(g2o.graph.poses[0].translation, (Eigen::Vector2d{4.0, 0.5}));
  ASSERT_EQ(g2o.graph.edges.size(), 1U);
  const Edge<GroupSe2>& edge = g2o.graph.edges[0];
  EXPECT_EQ(edge.from, 1U);
  EXPECT_EQ(edge.to, 0U);
  EXPECT_DOUBLE_EQ(edge.measured.yaw_rad, 0.25);
  const Eigen::Matrix3d expected = (Eigen::Matrix3d{} << 10, 1, 2, 1, 20, 3, 2, 3, 30).finished();
  EXPECT_EQ(edge.information, expected);
}

TEST(G2oFile, ReadsASpatialEdgeWithItsInformationRowByRow) {
  std::string text = "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0.6 0.8";
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) text += " " + std::to_string(i == j ? 100 + next : next), ++next;
  }
  const auto result = read(text + "\n");
  ASSERT_TRUE(std::holds_alternative<AnyGraph>(result));
  const auto& g2o = std::get<G2oGraph<GroupSe3>>(std::get<AnyGraph>(result));
  EXPECT_FALSE(g2o.complete);
  const Edge<GroupSe3>& edge = g2o.graph.edges[0];
  EXPECT_DOUBLE_EQ(edge.measured.rotation.z(), 0.6);
  EXPECT_DOUBLE_EQ(edge.measured.rotation.w(), 0.8);
  EXPECT_EQ(edge.information(0, 5), 5.0);
  EXPECT_EQ(edge.information(5, 0), 5.0);
  EXPECT_EQ(edge.information(1, 1), 106.0);
  EXPECT_EQ(edge.information(1, 2), 7.0);
}

TEST(G2oFile, WhatWasWrittenReadsAsTheSame) {
  for (const std::string& text : {std::string{kPlanar}, std::string{"VERTEX_SE3:QUAT 5 0.1 0.2 0.3 0.1 0.2 0.3 0.9\n"}}) {
    const auto first = read(text);
    ASSERT_TRUE(std::holds_alternative<AnyGraph>(first));
    const std::string once = written(std::get<AnyGraph>(first));
    const auto second = read(once);
    ASSERT_TRUE(std::holds_alternative<AnyGraph>(second));
    EXPECT_EQ(written(std::get<AnyGraph>(second)), once);
  }
}

TEST(G2oFile, TakesWhatOtherProgramsWrite) {
  const auto result = read(
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\r\n"
      "VERTEX_SE3:QUAT 6989586621679009792 1E0 -2.e-1 +3 0 0 0 -1\r\n"  // a0 of another library
      "EDGE_SE3:QUAT 6989586621679009792 6989586621679009793 1 2 3 0 0 0 1  1 0 0 0 0 0  1 0 0 0 0  1 0 0 0  0 0 0  0 0  0\r\n");
  ASSERT_TRUE(std::holds_alternative<AnyGraph>(result)) << std::get<G2oFault>(result).reason;
  const auto& g2o = std::get<G2oGraph<GroupSe3>>(std::get<AnyGraph>(result));
  EXPECT_EQ(g2o.ids.back(), 6989586621679009793);
  EXPECT_EQ(g2o.graph.poses[0].translation, (Eigen::Vector3d{1.0, -0.2, 3.0}));
  EXPECT_EQ(g2o.graph.edges[0].information.trace(), 3.0);  // nothing is known of the rotation
}

TEST(G2oFile, RefusesBadLinesWithTheirNumber) {
  expect_fault("", 0, "no pose");
  expect_fault("# nothing\n", 0, "no pose");
  expect_fault("VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 2 3\n", 2, "unknown record VERTEX_XY");
  expect_fault("VERTEX_SE2 0 0 0\n", 1, "4 values");
  expect_fault("VERTEX_SE2 0 0 0 0 0\n", 1, "4 values");
  expect_fault("VERTEX_SE2 0 0 nan 0\n", 1, "finite");
  expect_fault("VERTEX_SE2 0 0 1e999 0\n", 1, "finite");
  expect_fault("VERTEX_SE2 0 0 0x 0\n", 1, "finite");
  expect_fault("VERTEX_SE2 -1 0 0 0\n", 1, "id");
  expect_fault("VERTEX_SE2 9300000000000000000 0 0 0\n", 1, "id");
  expect_fault("VERTEX_SE2 1.0 0 0 0\n", 1, "id");
  expect_fault("VERTEX_SE2 0 0 0 0\n\nVERTEX_SE2 0 0 0 0\n", 3, "twice");
  expect_fault("EDGE_SE2 1 1 0 0 0 1 0 0 1 0 1\n", 1, "itself");
  expect_fault("EDGE_SE2 1 2 0 0 0 1 0 0 1 0 -1\n", 1, "positive semidefinite");
  expect_fault("EDGE_SE2 1 2 0 0 0 1 5 0 1 0 1\n", 1, "positive semidefinite");
  expect_fault("EDGE_SE2 1 2 0 0 0 0 0 0 0 0 0\n", 1, "zero");
  expect_fault("EDGE_SE2 1 2 0 0 0 1 0 0 1 0\n", 1, "11 values");
  expect_fault("VERTEX_SE2 0 0 0 0\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n", 2, "2D and 3D");
  expect_fault("FIX 9\nVERTEX_SE2 0 0 0 0\n", 1, "pose 9, which is not there");
  expect_fault("VERTEX_SE2 0 0 0 0\nFIX\n", 2, "without an id");
  expect_fault(kSpatial, 1, "quaternion");
  expect_fault("VERTEX_SE3:QUAT 0 1 2 3 0 0 0 0\n", 1, "quaternion");
}

}  // namespace
}  // namespace slamd::pgo
