#include "estimator/lidar/segmenter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamd {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

LidarPoint point(float x, float y, float z, std::uint8_t ring = 3) { return {x, y, z, 0, 0, ring, 10, 0}; }

std::vector<ScanSegment> room_for(std::size_t n) {
  std::vector<ScanSegment> out;
  out.reserve(n);
  return out;
}

/// Adds points along y at x = 10, 3 cm apart; the i-th at 1 ms * i.
void add_wall(Segmenter& segmenter, int count, std::vector<ScanSegment>& out, std::uint8_t ring = 3) {
  for (int i = 0; i < count; ++i)
    segmenter.add(point(10.0F, 0.03F * static_cast<float>(i), 0.5F, ring), 0.001F * static_cast<float>(i), out);
}

TEST(Segmenter, NeighboursBecomeTheirMeanInPlaceAndTime) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(10);
  add_wall(segmenter, 9, out);
  EXPECT_TRUE(out.empty()) << "the segment is still open";
  segmenter.finish(out);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_EQ(out[0].count, 9);
  EXPECT_EQ(out[0].ring, 3);
  EXPECT_FLOAT_EQ(out[0].x, 10.0F);
  EXPECT_NEAR(out[0].y, 0.12F, 1e-6);
  EXPECT_FLOAT_EQ(out[0].z, 0.5F);
  EXPECT_NEAR(out[0].time_s, 0.004F, 1e-8);
  EXPECT_NEAR(out[0].range_m, std::sqrt(100.0F + 0.0144F + 0.25F), 1e-5);
}

TEST(Segmenter, NoSegmentIsLongerThanTheLimitAndNoReturnIsLost) {
  const SegmenterConfig config;
  Segmenter segmenter{config};
  auto out = room_for(1000);
  add_wall(segmenter, 300, out);
  segmenter.finish(out);
  int returns = 0;
  for (const ScanSegment& segment : out) {
    returns += segment.count;
    EXPECT_LE(0.03F * static_cast<float>(segment.count - 1), config.max_length_m + 1e-4F);
  }
  EXPECT_EQ(returns, 300);
  EXPECT_GE(out.size(), 9.0F / (config.max_length_m + 0.03F));
}

TEST(Segmenter, AnEdgeInDepthEndsTheSegment) {
  Segmenter segmenter{SegmenterConfig{.max_length_m = 100.0F}};
  auto out = room_for(10);
  for (int i = 0; i < 5; ++i) segmenter.add(point(10.0F, 0.03F * static_cast<float>(i), 0.0F), 0.0F, out);
  for (int i = 5; i < 10; ++i) segmenter.add(point(12.0F, 0.03F * static_cast<float>(i), 0.0F), 0.0F, out);
  segmenter.finish(out);
  ASSERT_EQ(out.size(), 2U);
  EXPECT_FLOAT_EQ(out[0].x, 10.0F);
  EXPECT_FLOAT_EQ(out[1].x, 12.0F);
}

TEST(Segmenter, TheAllowedStepGrowsWithRange) {
  const SegmenterConfig config{.max_length_m = 10.0F, .max_step_m = 0.15F, .max_step_per_range = 0.012F};
  for (const auto& [range, expected] : {std::pair{5.0F, 2U}, std::pair{60.0F, 1U}}) {
    Segmenter segmenter{config};
    auto out = room_for(10);
    segmenter.add(point(range, 0.0F, 0.0F), 0.0F, out);
    segmenter.add(point(range, 0.5F, 0.0F), 0.0F, out);
    segmenter.finish(out);
    EXPECT_EQ(out.size(), expected) << "at " << range << " m";
  }
}

TEST(Segmenter, RingsDoNotMix) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(10);
  for (int i = 0; i < 4; ++i)
    for (std::uint8_t ring = 0; ring < 3; ++ring)
      segmenter.add(point(10.0F, 0.03F * static_cast<float>(i), 0.01F * ring, ring), 0.0F, out);
  segmenter.finish(out);
  ASSERT_EQ(out.size(), 3U);
  for (const ScanSegment& segment : out) EXPECT_NEAR(segment.z, 0.01F * segment.ring, 1e-6);
}

TEST(Segmenter, BadPointsAreLeftOut) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(10);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const LidarPoint& bad :
       {point(kNan, 0, 0), point(0, kNan, 0), point(10, 0, kNan), point(kInf, 0, 0), point(10, -kInf, 0),
        point(0.2F, 0.1F, 0), point(150, 0, 0), point(0, 0, 0), point(10, 0, 0, 128), point(10, 0, 0, 255)})
    segmenter.add(bad, 0.0F, out);
  LidarPoint second = point(10, 0, 0);
  second.return_index = 1;
  segmenter.add(second, 0.0F, out);
  segmenter.finish(out);
  EXPECT_TRUE(out.empty());
}

TEST(Segmenter, ABadPointBetweenNeighboursDoesNotSpoilTheMean) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(10);
  segmenter.add(point(10, 0, 0), 0.0F, out);
  segmenter.add(point(kNan, 0, 0), 0.0F, out);
  segmenter.add(point(10, 0.02F, 0), 0.0F, out);
  segmenter.finish(out);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_NEAR(out[0].y, 0.01F, 1e-6);
}

TEST(Segmenter, AFullOutputIsNeverGrown) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(2);
  const std::size_t capacity = out.capacity();
  for (int i = 0; i < 50; ++i) segmenter.add(point(10.0F, static_cast<float>(i), 0.0F), 0.0F, out);
  segmenter.finish(out);
  EXPECT_EQ(out.size(), capacity);
  EXPECT_EQ(out.capacity(), capacity);
}

TEST(Segmenter, FinishLeavesNothingForTheNextScan) {
  Segmenter segmenter{SegmenterConfig{}};
  auto out = room_for(10);
  add_wall(segmenter, 5, out);
  segmenter.finish(out);
  out.clear();
  segmenter.finish(out);
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace slamd
