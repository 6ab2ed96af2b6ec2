// What rays say of squares: free along them, occupied at their end, unknown beyond; and the snapshot's place.
#include "estimator/grid/occupancy_builder.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

PlanarScan scan_of(std::vector<Eigen::Vector2f> points) {
  PlanarScan scan;
  scan.points = std::move(points);
  return scan;
}

std::int8_t cell_at(const OccupancyGrid& grid, double x, double y) {
  const auto column = static_cast<std::size_t>((x - grid.origin.x()) / grid.resolution_m);
  const auto row = static_cast<std::size_t>((y - grid.origin.y()) / grid.resolution_m);
  return grid.cells.at(row * grid.width + column);
}

TEST(OccupancyBuilder, RaysFreeTheirWayAndOccupyTheirEnd) {
  OccupancyBuilder builder{OccupancyConfig{}};
  const PlanarPose pose{{10.0, -5.0}, 1.5707963267948966};  // looks along y
  for (int i = 0; i < 5; ++i) builder.add(scan_of({{2.025F, 0.025F}, {1.525F, -1.025F}}), pose);
  const OccupancyGrid grid = builder.snapshot();
  EXPECT_EQ(grid.cells.size(), static_cast<std::size_t>(grid.width) * grid.height);
  EXPECT_EQ(cell_at(grid, 9.975, -2.975), kOccupiedCell);
  EXPECT_EQ(cell_at(grid, 9.98, -3.2), kFreeCell);
  EXPECT_EQ(cell_at(grid, 11.02, -3.48), kOccupiedCell);
  EXPECT_EQ(cell_at(grid, 10.9, -4.9), kUnknownCell) << "no ray went there";
  EXPECT_LT(builder.log_odds({9.98, -3.2}), 0.0);
  EXPECT_GT(builder.log_odds({9.975, -2.975}), 0.0);
  EXPECT_EQ(builder.log_odds({100.0, 100.0}), 0.0);
}

TEST(OccupancyBuilder, WhatHasMovedAwayIsFreeInTheEnd) {
  OccupancyBuilder builder{OccupancyConfig{}};
  for (int i = 0; i < 3; ++i) builder.add(scan_of({{1.0F, 0.01F}}), PlanarPose{});
  EXPECT_EQ(cell_at(builder.snapshot(), 1.0, 0.01), kOccupiedCell);
  for (int i = 0; i < 30; ++i) builder.add(scan_of({{3.0F, 0.01F}}), PlanarPose{});
  EXPECT_EQ(cell_at(builder.snapshot(), 1.0, 0.01), kFreeCell);
}

TEST(OccupancyBuilder, NothingSeenIsNoGrid) {
  const OccupancyGrid grid = OccupancyBuilder{OccupancyConfig{}}.snapshot();
  EXPECT_EQ(grid.width * grid.height, 0U);
  EXPECT_TRUE(grid.cells.empty());
}

}  // namespace
}  // namespace slamd
