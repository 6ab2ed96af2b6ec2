#include "daemon/store/checkpoint_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace slamd {
namespace {

StoredMap some_map() {
  StoredMap map;
  for (int i = 0; i < 5; ++i) {
    StoredKeyframe keyframe;
    keyframe.time = HostTime{std::chrono::seconds{10 + i}};
    keyframe.T_map_base.translation = {1.5 * i, 0.25, -1.0};
    keyframe.T_map_base.rotation = Eigen::AngleAxisd{0.1 * i, Eigen::Vector3d::UnitZ()};
    keyframe.relative_covariance = 1e-4 * (i + 1) * Matrix6d::Identity();
    keyframe.cloud.assign(static_cast<std::size_t>(300 * i), static_cast<std::uint8_t>(i));
    map.keyframes.push_back(keyframe);
  }
  map.closures = {{.from = 0, .to = 4, .T_from_to = {Eigen::Quaterniond::Identity(), {6.0, 0.0, 0.0}}, .covariance = 1e-3 * Matrix6d::Identity()}};
  map.T_map_base.translation = {6.5, 0.3, -1.0};
  map.sensors = {.gyro_bias_rads = {1e-3, 2e-3, 3e-3}, .accel_bias_mps2 = {0.1, 0.2, 0.3}, .T_imu_lidar = {Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.4}}};
  map.motion = StoredMotion{.time = HostTime{std::chrono::seconds{15}}, .host_to_utc = std::chrono::hours{5}, .velocity_mps = {8.0, 0.1, 0.0}, .angular_velocity_rads = {0.0, 0.0, 0.2}};
  map.enu_valid = true;
  map.enu = StoredEnu{.yaw_rad = 0.7, .translation = {100.0, 200.0, 3.0}, .covariance = {}, .latitude_deg = 50.0,
                      .longitude_deg = 8.5, .ellipsoid_height_m = 160.0};
  return map;
}

/// The i-th after some_map().
StoredStep some_step(int i) {
  StoredStep step;
  step.time = HostTime{std::chrono::seconds{20 + i}};
  step.T_before_this = {Eigen::Quaterniond{Eigen::AngleAxisd{0.5, Eigen::Vector3d::UnitZ()}}, {1.5, 0.0, 0.0}};
  step.relative_covariance = 1e-5 * Matrix6d::Identity();
  step.cloud.assign(100, static_cast<std::uint8_t>(i));
  step.motion = {.time = step.time, .host_to_utc = std::chrono::hours{5}, .velocity_mps = {7.0 + i, 0.0, 0.0}, .angular_velocity_rads = Eigen::Vector3d::Zero()};
  step.sensors.gyro_bias_rads = {0.001 * i, 0.0, 0.0};
  return step;
}

void append(std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

VehicleGeometry some_vehicle() { return {.T_base_lidar = {Eigen::Quaterniond::Identity(), {0.4, 0.0, 1.9}}, .T_base_imu = {}, .p_base_antenna = Eigen::Vector3d::Zero()}; }

TEST(CheckpointFile, WhatWasStoredComesBackToTheBit) {
  const StoredMap map = some_map();
  const Result<StoredMap> back = decode(encode(map, some_vehicle()), some_vehicle());
  ASSERT_TRUE(back) << back.reason();
  ASSERT_EQ(back->keyframes.size(), map.keyframes.size());
  for (std::size_t i = 0; i < map.keyframes.size(); ++i) {
    EXPECT_EQ(back->keyframes[i].time, map.keyframes[i].time);
    EXPECT_EQ(back->keyframes[i].T_map_base.translation, map.keyframes[i].T_map_base.translation);
    EXPECT_EQ(back->keyframes[i].T_map_base.rotation.coeffs(), map.keyframes[i].T_map_base.rotation.coeffs());
    EXPECT_EQ(back->keyframes[i].relative_covariance, map.keyframes[i].relative_covariance);
    EXPECT_EQ(back->keyframes[i].cloud, map.keyframes[i].cloud);
  }
  ASSERT_EQ(back->closures.size(), 1U);
  EXPECT_EQ(back->closures[0].from, 0U);
  EXPECT_EQ(back->closures[0].to, 4U);
  EXPECT_EQ(back->closures[0].T_from_to.translation, map.closures[0].T_from_to.translation);
  EXPECT_EQ(back->closures[0].covariance, map.closures[0].covariance);
  EXPECT_EQ(back->sensors.gyro_bias_rads, map.sensors.gyro_bias_rads);
  EXPECT_EQ(back->sensors.accel_bias_mps2, map.sensors.accel_bias_mps2);
  EXPECT_EQ(back->sensors.T_imu_lidar.translation, map.sensors.T_imu_lidar.translation);
  EXPECT_EQ(back->T_map_base.translation, map.T_map_base.translation);
  ASSERT_TRUE(back->motion);
  EXPECT_EQ(back->motion->time, map.motion->time);
  EXPECT_EQ(back->motion->host_to_utc, map.motion->host_to_utc);
  EXPECT_EQ(back->motion->velocity_mps, map.motion->velocity_mps);
  EXPECT_EQ(back->motion->angular_velocity_rads, map.motion->angular_velocity_rads);
  ASSERT_TRUE(back->enu_valid);
  EXPECT_EQ(back->enu.yaw_rad, 0.7);
  EXPECT_EQ(back->enu.latitude_deg, 50.0);
}

TEST(CheckpointFile, AnyByteChangedOrMissingIsRefused) {
  const std::vector<std::uint8_t> good = encode(some_map(), some_vehicle());
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::vector<std::uint8_t> bad = good;
    bad[i] ^= 0x10U;
    EXPECT_FALSE(decode(bad, some_vehicle())) << "byte " << i;
    EXPECT_FALSE(decode(std::span{good}.first(i), some_vehicle())) << "cut to " << i;
  }
}

TEST(CheckpointFile, StepsGoOnFromTheMapsLastKeyframe) {
  std::vector<std::uint8_t> bytes = encode(some_map(), some_vehicle());
  for (int i = 0; i < 3; ++i) append(bytes, encode(some_step(i)));
  const Result<StoredMap> back = decode(bytes, some_vehicle());
  ASSERT_TRUE(back) << back.reason();
  ASSERT_EQ(back->keyframes.size(), 8U);
  Pose T_map_base = some_map().keyframes.back().T_map_base;
  for (int i = 0; i < 3; ++i) {
    const StoredKeyframe& keyframe = back->keyframes[5 + static_cast<std::size_t>(i)];
    T_map_base = T_map_base * some_step(i).T_before_this;
    EXPECT_EQ(keyframe.time, some_step(i).time);
    EXPECT_LT((keyframe.T_map_base.translation - T_map_base.translation).norm(), 1e-12);
    EXPECT_LT(keyframe.T_map_base.rotation.angularDistance(T_map_base.rotation), 1e-12);
    EXPECT_EQ(keyframe.relative_covariance, some_step(i).relative_covariance);
    EXPECT_EQ(keyframe.cloud, some_step(i).cloud);
  }
  EXPECT_EQ(back->T_map_base.translation, back->keyframes.back().T_map_base.translation);
  ASSERT_TRUE(back->motion);
  EXPECT_EQ(back->motion->velocity_mps.x(), 9.0);
  EXPECT_EQ(back->sensors.gyro_bias_rads.x(), 0.002);
}

TEST(CheckpointFile, AStepThatIsTornOrDamagedIsTheLast) {
  const std::vector<std::uint8_t> whole = encode(some_map(), some_vehicle());
  std::vector<std::uint8_t> good = whole;
  for (int i = 0; i < 3; ++i) append(good, encode(some_step(i)));
  const std::size_t step = encode(some_step(0)).size();
  for (std::size_t i = whole.size(); i < good.size(); i += 7) {
    std::vector<std::uint8_t> bad = good;
    bad[i] ^= 0x10U;
    const std::span<const std::uint8_t> damaged{bad}, torn{good.data(), i};
    for (const std::span<const std::uint8_t> bytes : {damaged, torn}) {
      const Result<StoredMap> back = decode(bytes, some_vehicle());
      ASSERT_TRUE(back) << back.reason();
      EXPECT_EQ(back->keyframes.size(), 5U + (i - whole.size()) / step) << "byte " << i;
    }
  }
}

TEST(CheckpointFile, AStepThatIsOlderThanTheMapIsTheLast) {
  std::vector<std::uint8_t> bytes = encode(some_map(), some_vehicle());
  append(bytes, encode(some_step(1)));
  append(bytes, encode(some_step(0)));
  append(bytes, encode(some_step(2)));
  EXPECT_EQ(decode(bytes, some_vehicle())->keyframes.size(), 6U);
}

TEST(CheckpointFile, AnotherVehicleOrVersionIsRefusedWithItsReason) {
  std::vector<std::uint8_t> bytes = encode(some_map(), some_vehicle());
  VehicleGeometry other = some_vehicle();
  other.T_base_lidar.translation.z() += 0.01;
  const Result<StoredMap> moved = decode(bytes, other);
  ASSERT_FALSE(moved);
  EXPECT_NE(std::string{moved.reason()}.find("another vehicle"), std::string::npos);
  bytes[8] = 99;
  const Result<StoredMap> newer = decode(bytes, some_vehicle());
  ASSERT_FALSE(newer);
  EXPECT_NE(std::string{newer.reason()}.find("version"), std::string::npos);
}

TEST(CheckpointFile, ClosuresOfKeyframesThatAreNotThereAreRefused) {
  StoredMap map = some_map();
  map.closures[0].to = 5;
  EXPECT_FALSE(decode(encode(map, some_vehicle()), some_vehicle()));
  map.closures[0].from = map.closures[0].to = 3;
  EXPECT_FALSE(decode(encode(map, some_vehicle()), some_vehicle()));
}

TEST(CheckpointFile, NumbersThatAreNoneAreRefusedThoughTheChecksumHolds) {
  StoredMap map = some_map();
  map.keyframes[2].T_map_base.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decode(encode(map, some_vehicle()), some_vehicle()));
  map = some_map();
  map.T_map_base.rotation.coeffs() *= 2.0;
  EXPECT_FALSE(decode(encode(map, some_vehicle()), some_vehicle()));
  map = some_map();
  std::swap(map.keyframes[1], map.keyframes[2]);
  EXPECT_FALSE(decode(encode(map, some_vehicle()), some_vehicle())) << "times out of order";
}

class CheckpointOnDisk : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::string folder_ = testing::TempDir() + "checkpoint_" + std::to_string(::getpid());
  const std::string path_ = folder_ + "/checkpoint.map";
};

TEST_F(CheckpointOnDisk, IsWrittenWholeAndReadableByOwnerAndGroupOnly) {
  const std::vector<std::uint8_t> bytes = encode(some_map(), some_vehicle());
  ASSERT_TRUE(write_checkpoint(bytes, path_));
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  const auto back = read_checkpoint(path_);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, bytes);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder_}, {}), 1) << "nothing temporary is left";
}

TEST_F(CheckpointOnDisk, IsAddedToAtItsEnd) {
  EXPECT_FALSE(append_to_checkpoint(encode(some_step(0)), path_)) << "there is none";
  ASSERT_TRUE(write_checkpoint(encode(some_map(), some_vehicle()), path_));
  ASSERT_TRUE(append_to_checkpoint(encode(some_step(0)), path_));
  ASSERT_TRUE(append_to_checkpoint(encode(some_step(1)), path_));
  EXPECT_EQ(load_checkpoint(path_, some_vehicle())->keyframes.size(), 7U);
  ASSERT_TRUE(write_checkpoint(encode(some_map(), some_vehicle()), path_));
  EXPECT_EQ(load_checkpoint(path_, some_vehicle())->keyframes.size(), 5U) << "a whole one takes the place of all";
}

TEST_F(CheckpointOnDisk, NoneIsNoError) {
  const auto none = read_checkpoint(path_);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
}

TEST_F(CheckpointOnDisk, AFolderOrALinkInItsPlaceIsRefused) {
  std::filesystem::create_directory(path_);
  EXPECT_FALSE(read_checkpoint(path_));
  std::filesystem::remove(path_);
  std::filesystem::create_symlink("/etc/hostname", path_);
  EXPECT_FALSE(read_checkpoint(path_));
}

TEST_F(CheckpointOnDisk, AFullDiskLeavesTheOldOneAsItWas) {
  const std::vector<std::uint8_t> old = encode(some_map(), some_vehicle());
  ASSERT_TRUE(write_checkpoint(old, path_));
  std::filesystem::create_directory(folder_ + "/full");
  EXPECT_FALSE(write_checkpoint(old, "/proc/checkpoint.map")) << "a place that takes no file";
  EXPECT_EQ(*read_checkpoint(path_), old);
}

}  // namespace
}  // namespace slamd
