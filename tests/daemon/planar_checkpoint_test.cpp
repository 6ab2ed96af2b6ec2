// A planar map as bytes: what is whole comes back, what is torn ends the map, what is of another vehicle is refused.

#include "daemon/store/planar_checkpoint.hpp"

#include <gtest/gtest.h>

#include <string>

#include "daemon/store/checkpoint_file.hpp"

namespace slamd {
namespace {

StoredPlanarKeyframe keyframe_at(std::int64_t time_ns) {
  StoredPlanarKeyframe keyframe;
  keyframe.time = from_ns<HostTime>(time_ns);
  keyframe.pose = {0.25 * static_cast<double>(time_ns), -3.0, 1.5};
  keyframe.origin = {0.45F, 0.0F};
  for (int i = 0; i < 50; ++i) keyframe.points.emplace_back(0.1F * static_cast<float>(i), -20.0F);
  return keyframe;
}

std::vector<std::uint8_t> file_of(int keyframes, const VehicleGeometry& vehicle = {}) {
  std::vector<std::uint8_t> bytes = encode_planar_head(vehicle);
  for (int i = 1; i <= keyframes; ++i) {
    const std::vector<std::uint8_t> one = encode(keyframe_at(i));
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  return bytes;
}

TEST(PlanarCheckpoint, WhatIsStoredComesBack) {
  const Result<StoredPlanarMap> map = decode_planar(file_of(3), {});
  ASSERT_TRUE(map);
  ASSERT_EQ(map->size(), 3U);
  const StoredPlanarKeyframe& last = map->back();
  EXPECT_EQ(last.time, from_ns<HostTime>(3));
  EXPECT_EQ(last.pose, Eigen::Vector3d(0.75, -3.0, 1.5));
  EXPECT_FLOAT_EQ(last.origin.x(), 0.45F);
  ASSERT_EQ(last.points.size(), 50U);
  EXPECT_NEAR(last.points[37].x(), 3.7F, 0.0026F);
}

TEST(PlanarCheckpoint, PointsThatNoLidarSeesAreLeftOut) {
  StoredPlanarKeyframe keyframe = keyframe_at(1);
  keyframe.points[5].x() = 1000.0F;
  keyframe.points[6].y() = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::uint8_t> bytes = encode_planar_head({});
  const std::vector<std::uint8_t> one = encode(keyframe);
  bytes.insert(bytes.end(), one.begin(), one.end());
  EXPECT_EQ(decode_planar(bytes, {})->front().points.size(), 48U);
}

TEST(PlanarCheckpoint, AtEveryLengthTheKeyframesThatAreWholeComeBack) {
  const std::vector<std::uint8_t> whole = file_of(3);
  const std::size_t head = encode_planar_head({}).size(), one = encode(keyframe_at(1)).size();
  for (std::size_t size = 0; size <= whole.size(); size += 7) {
    const Result<StoredPlanarMap> map = decode_planar(std::span{whole}.first(size), {});
    ASSERT_EQ(static_cast<bool>(map), size >= head) << size;
    if (!map) continue;
    ASSERT_EQ(map->size(), (size - head) / one) << size;
  }
}

TEST(PlanarCheckpoint, ADamagedByteEndsTheMapThere) {
  const std::size_t head = encode_planar_head({}).size(), one = encode(keyframe_at(1)).size();
  for (std::size_t at = head; at < head + 2 * one; at += 11) {
    std::vector<std::uint8_t> bytes = file_of(2);
    bytes[at] ^= 0x10U;
    const Result<StoredPlanarMap> map = decode_planar(bytes, {});
    ASSERT_TRUE(map);
    EXPECT_EQ(map->size(), at < head + one ? 0U : 1U) << at;
  }
}

TEST(PlanarCheckpoint, AnotherVehicleAnotherVersionAndAnotherFileAreRefused) {
  VehicleGeometry moved;
  moved.T_base_lidar.translation.x() = 0.01;
  EXPECT_STREQ(decode_planar(file_of(1, moved), {}).reason(), "the checkpoint is of another vehicle, or the sensors have been moved");
  std::vector<std::uint8_t> damaged = file_of(1);
  damaged[8] ^= 1U;
  EXPECT_STREQ(decode_planar(damaged, {}).reason(), "the checkpoint is damaged or torn");
  const std::string other = "SLAMDMAP and more";
  EXPECT_STREQ(decode_planar({reinterpret_cast<const std::uint8_t*>(other.data()), other.size()}, {}).reason(),
               "this is no checkpoint of planar mode");
}

TEST(PlanarCheckpoint, TimesThatGoBackEndTheMap) {
  std::vector<std::uint8_t> bytes = file_of(2);
  const std::vector<std::uint8_t> again = encode(keyframe_at(2));
  bytes.insert(bytes.end(), again.begin(), again.end());
  EXPECT_EQ(decode_planar(bytes, {})->size(), 2U);
}

TEST(PlanarCheckpoint, AFileThatIsNotThereIsAnEmptyMap) {
  const Result<StoredPlanarMap> map = load_planar_checkpoint(testing::TempDir() + "no_such_planar.map", {});
  ASSERT_TRUE(map);
  EXPECT_TRUE(map->empty());
}

}  // namespace
}  // namespace slamd
