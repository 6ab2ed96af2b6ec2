#pragma once
// The map, queries and batches that the k-d tree benchmarks share: 100,000 points a voxel apart, queries near surfaces
// in scan order, and batches of new scans.

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <unordered_set>
#include <vector>

#include "tests/bench/lidar_world.hpp"

namespace slamd::bench {

inline constexpr float kVoxel = 0.5F;
inline constexpr std::size_t kBatch = 2'000;
inline constexpr std::size_t kMapPoints = 100'000;
inline constexpr std::size_t kBatches = 100;

enum class World { kLidar = 0, kUniform = 1 };

struct MapFixture {
  std::vector<Eigen::Vector3f> points;                // one a voxel, in the order of the drive
  std::vector<Eigen::Vector3f> queries;               // a scan over that map, 0.1 m off, in firing order
  std::vector<std::vector<Eigen::Vector3f>> batches;  // the drive goes on
};

inline std::uint64_t voxel_key(const Eigen::Vector3f& point) {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis)
    key = key << 21 | (static_cast<std::uint64_t>(std::floor(point[axis] / kVoxel) + 1e6F) & 0x1FFFFF);
  return key;
}

/// The next scan of the drive, or points anywhere in a box for the uniform world; exactly kBatch points.
class Drive {
 public:
  explicit Drive(World world) : world_(world) {}

  std::vector<Eigen::Vector3f> next() {
    std::vector<Eigen::Vector3f> points;
    if (world_ == World::kUniform) {
      std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
      for (std::size_t i = 0; i < kBatch; ++i)
        points.emplace_back(150.0F * unit(random_), 150.0F * unit(random_), 5.0F * unit(random_));
      return points;
    }
    points = lidar_.scan(travelled_ += 0.8F, 8);
    points.resize(std::min(points.size(), kBatch), Eigen::Vector3f::Zero());
    return points;
  }

 private:
  World world_;
  LidarWorld lidar_;
  std::mt19937 random_{5};
  float travelled_ = 0.0F;
};

inline MapFixture make_fixture(World world) {
  MapFixture map;
  Drive drive(world);
  std::unordered_set<std::uint64_t> voxels;
  while (map.points.size() < kMapPoints)
    for (const Eigen::Vector3f& point : drive.next())
      if (map.points.size() < kMapPoints && voxels.insert(voxel_key(point)).second) map.points.push_back(point);
  for (const Eigen::Vector3f& point : drive.next())
    map.queries.push_back(point + Eigen::Vector3f(0.06F, -0.06F, 0.05F));
  for (std::size_t i = 0; i < kBatches; ++i) map.batches.push_back(drive.next());
  return map;
}

inline const MapFixture& fixture(World world) {
  static const MapFixture lidar = make_fixture(World::kLidar);
  static const MapFixture uniform = make_fixture(World::kUniform);
  return world == World::kLidar ? lidar : uniform;
}

}  // namespace slamd::bench
