#include "daemon/server/pose_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimator/types/nav_state.hpp"

namespace slamd {
namespace {

using nlohmann::json;

TEST(PoseText, GivesEveryNumberBackToTheBit) {
  PoseSample sample;
  sample.host_time_ns = std::numeric_limits<std::int64_t>::max();
  sample.utc_offset_ns = -7;
  sample.sequence = std::numeric_limits<std::uint64_t>::max();
  sample.map_position_m = {1.0 / 3.0, -123456.789, 5e-324};
  sample.odom_rotation_xyzw = {0.1, -0.2, 1e-17, std::nextafter(1.0, 0.0)};
  for (std::size_t i = 0; i < 36; ++i) sample.covariance[i] = std::pow(-7.3, static_cast<double>(i) - 18.0);
  sample.lidar_test_ratio = 0.1F;
  sample.map_corrections = 42;
  const json pose = json::parse(pose_text(sample));
  EXPECT_EQ(pose.at("time_ns"), sample.host_time_ns);
  EXPECT_EQ(pose.at("utc_offset_ns"), -7);
  EXPECT_EQ(pose.at("sequence"), sample.sequence);
  EXPECT_EQ(pose.at("T_map_base").at("translation_m"), json(sample.map_position_m));
  EXPECT_EQ(pose.at("T_odom_base").at("rotation_quat_xyzw"), json(sample.odom_rotation_xyzw));
  EXPECT_EQ(pose.at("covariance"), json(sample.covariance));
  EXPECT_EQ(pose.at("lidar_test_ratio"), static_cast<double>(0.1F));
  EXPECT_EQ(pose.at("map_corrections"), 42);
}

TEST(PoseText, SaysNullOfWhatIsNotKnownOrNoNumberAndNeverAnIntegerOfARealNumber) {
  PoseSample sample;
  sample.velocity_mps = {std::nan(""), std::numeric_limits<double>::infinity(), 3.0};
  const json pose = json::parse(pose_text(sample));
  EXPECT_TRUE(pose.at("utc_offset_ns").is_null());
  EXPECT_TRUE(pose.at("velocity_mps")[0].is_null());
  EXPECT_TRUE(pose.at("velocity_mps")[1].is_null());
  EXPECT_TRUE(pose.at("velocity_mps")[2].is_number_float());
  EXPECT_EQ(pose.at("velocity_mps")[2], 3.0);
}

TEST(PoseText, NamesStatusAndReasons) {
  PoseSample sample;
  EXPECT_EQ(json::parse(pose_text(sample)).at("reasons"), json::array());
  sample.status = static_cast<std::uint32_t>(TrackingStatus::kDegraded);
  sample.reasons = bit(StatusReason::kNoLidar) | bit(StatusReason::kNoImu);
  const json pose = json::parse(pose_text(sample));
  EXPECT_EQ(pose.at("status"), "DEGRADED");
  EXPECT_EQ(pose.at("reasons").size(), 2U);
  EXPECT_EQ(pose.at("reasons"), reason_names(sample.reasons));
}

}  // namespace
}  // namespace slamd
