// What topics become: roles by type, times, clouds as packets.
#include "tools/slam-replay/bag/bag_sensors.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "drivers/ros/message_writer.hpp"
#include "tests/support/bag_files.hpp"
#include "tools/slam-replay/drive/drive.hpp"

namespace slamd::replay {
namespace {

using test::SentMessage;

constexpr std::int64_t kBegin_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kMs = 1'000'000;

std::vector<std::uint8_t> imu(std::int64_t stamp_ns, double accel = 9.81, double gyro = 0.5) {
  MessageWriter writer;
  writer.header(stamp_ns, "imu");
  for (int i = 0; i < 13; ++i) writer.put(0.0);
  writer.put_all(std::array{gyro, 0.0, 0.0});
  for (int i = 0; i < 9; ++i) writer.put(0.0);
  writer.put_all(std::array{0.0, 0.0, accel});
  for (int i = 0; i < 9; ++i) writer.put(0.0);
  return writer.bytes();
}

std::vector<std::uint8_t> fix(std::int64_t stamp_ns, std::int8_t status, double variance) {
  MessageWriter writer;
  writer.header(stamp_ns, "gps").put(status).put(std::uint16_t{1}).put_all(std::array{49.0, 8.0, 100.0});
  for (int i = 0; i < 9; ++i) writer.put(i % 4 == 0 ? variance : 0.0);
  return MessageWriter{writer}.put(std::uint8_t{2}).bytes();
}

/// One turn of 16 lasers, 90 firings, clockwise or not, on a cylinder of 10 m.
struct CloudShape {
  bool with_ring = true, with_time = true, clockwise = true;
  bool float_seconds = true;  // else nanoseconds as uint32
};

std::vector<std::uint8_t> cloud(std::int64_t stamp_ns, const CloudShape& shape) {
  MessageWriter writer;
  writer.header(stamp_ns, "lidar").put(std::uint32_t{1}).put(std::uint32_t{90 * 16});
  writer.count(3U + (shape.with_ring ? 1 : 0) + (shape.with_time ? 1 : 0));
  const auto field = [&writer](const char* name, std::uint32_t offset, std::uint8_t type) {
    writer.text(name).put(offset).put(type).put(std::uint32_t{1});
  };
  field("x", 0, 7), field("y", 4, 7), field("z", 8, 7);
  if (shape.with_ring) field("ring", 12, 4);
  if (shape.with_time) field(shape.float_seconds ? "time" : "t", 16, shape.float_seconds ? 7 : 6);
  std::vector<std::uint8_t> points;
  for (int firing = 0; firing < 90; ++firing) {
    for (int laser = 0; laser < 16; ++laser) {
      const double azimuth = (shape.clockwise ? -1.0 : 1.0) * firing * 2.0 * std::numbers::pi / 90.0;
      const double elevation = (laser * 2 - 15) * std::numbers::pi / 180.0;
      const double time_s = firing * 0.1 / 90.0;
      MessageWriter point{RosEncoding::kRos1};  // packed
      point.put_all(std::array{static_cast<float>(10.0 * std::cos(azimuth)), static_cast<float>(10.0 * std::sin(azimuth)),
                               static_cast<float>(10.0 * std::tan(elevation))});
      point.put(static_cast<std::uint16_t>(laser)).put(std::uint16_t{0});
      if (shape.float_seconds) point.put(static_cast<float>(time_s));
      else point.put(static_cast<std::uint32_t>(time_s * 1e9));
      points.insert(points.end(), point.bytes().begin(), point.bytes().end());
    }
  }
  writer.put(std::uint8_t{0}).put(std::uint32_t{20}).put(std::uint32_t{90 * 16 * 20}).byte_sequence(points).put(std::uint8_t{1});
  return writer.bytes();
}

class BagSensorsTest : public testing::Test {
 protected:
  BagSensorsTest() { std::filesystem::create_directories(folder_); }
  ~BagSensorsTest() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<Bag> bag(const std::vector<SentMessage>& messages) {
    const std::string path = folder_ + "/" + std::to_string(++made_) + ".db3";
    test::make_db3(path, messages);
    OpenedBag opened = open_bag(path);
    return std::move(std::get<std::unique_ptr<Bag>>(opened));
  }
  Sensors sensors(const std::vector<SentMessage>& messages, const TopicWishes& wishes = {}) {
    BagSensors made = open_sensors(*bag(messages), wishes, {});
    EXPECT_EQ(made.fault, "");
    notes_ = made.notes;
    return std::move(made.sensors);
  }

  const std::string folder_ = testing::TempDir() + "bag_sensors_test_" + std::to_string(::getpid());
  int made_ = 0;
  std::vector<std::string> notes_;
};

SentMessage imu_at(const std::string& topic, std::int64_t recorded_ns, std::int64_t stamp_ns) {
  return {topic, "sensor_msgs/msg/Imu", recorded_ns, imu(stamp_ns)};
}

TEST_F(BagSensorsTest, RolesGoByTypeThenByMessagesAndWishesWin) {
  std::vector<SentMessage> messages;
  for (int i = 0; i < 4; ++i) messages.push_back(imu_at("/few", kBegin_ns + i, kBegin_ns + i));
  for (int i = 0; i < 9; ++i) messages.push_back(imu_at("/many", kBegin_ns + i, kBegin_ns + i));
  messages.push_back({"/camera", "sensor_msgs/msg/Image", kBegin_ns, {1}});
  const std::unique_ptr<Bag> opened = bag(messages);
  const auto role = [&](const std::string& topic, const TopicWishes& wishes) {
    for (const TopicUse& use : assign_roles(opened->topics(), wishes)) {
      if (use.topic.name == topic) return use.role;
    }
    return std::string{"?"};
  };
  EXPECT_EQ(role("/many", {}), "imu");
  EXPECT_EQ(role("/few", {}), "");
  EXPECT_EQ(role("/few", {{"imu", "/few"}}), "imu");
  EXPECT_EQ(role("/many", {{"imu", "/few"}}), "");
  EXPECT_EQ(role("/many", {{"imu", ""}}), "") << "none is wished for";
  EXPECT_EQ(role("/camera", {}), "");
}

TEST_F(BagSensorsTest, AWishThatCannotBeMetIsAFaultWithItsReason) {
  const std::unique_ptr<Bag> opened = bag({imu_at("/imu", kBegin_ns, kBegin_ns)});
  EXPECT_NE(open_sensors(*opened, {{"lidar", "/nowhere"}}, {}).fault.find("there is no such topic"), std::string::npos);
  EXPECT_NE(open_sensors(*opened, {{"lidar", "/imu"}}, {}).fault.find("sensor_msgs/Imu, which is no lidar"), std::string::npos);
  EXPECT_NE(open_sensors(*opened, {{"radar", "/imu"}}, {}).fault.find("may be lidar, imu"), std::string::npos);
}

TEST_F(BagSensorsTest, ABagThatWasRecordedFromABagKeepsItsStamps) {
  const std::int64_t years_ns = std::int64_t{3'000'000} * 1'000 * kMs;
  std::vector<SentMessage> messages;
  for (int i = 0; i < 20; ++i) messages.push_back(imu_at("/imu", kBegin_ns + years_ns + i * 7 * kMs, kBegin_ns + i * 5 * kMs));
  const Sensors made = sensors(messages);
  ASSERT_NE(made.imu, nullptr);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(to_ns(made.imu->next()->time), kBegin_ns + i * 5 * kMs);
}

TEST_F(BagSensorsTest, AClockOfItsOwnIsMovedToTheRecordings) {
  std::vector<SentMessage> messages;
  for (int i = 0; i < 20; ++i) {
    messages.push_back(imu_at("/imu", kBegin_ns + i * 5 * kMs, kBegin_ns + i * 5 * kMs));
    messages.push_back({"/fix", "sensor_msgs/msg/NavSatFix", kBegin_ns + i * 100 * kMs, fix(i * 100 * kMs + 1'000'000 * kMs, 0, 4.0)});
  }
  const Sensors made = sensors(messages);
  ASSERT_NE(made.gnss, nullptr);
  EXPECT_EQ(to_ns(made.gnss->next()->time), kBegin_ns);
  EXPECT_EQ(to_ns(made.gnss->next()->time), kBegin_ns + 100 * kMs);
  EXPECT_EQ(to_ns(made.imu->next()->time), kBegin_ns);
}

TEST_F(BagSensorsTest, HeadersWithoutStampsTakeTheTimeOfRecording) {
  std::vector<SentMessage> messages;
  for (int i = 0; i < 5; ++i) messages.push_back(imu_at("/imu", kBegin_ns + i * 5 * kMs, 0));
  const Sensors made = sensors(messages);
  EXPECT_EQ(to_ns(made.imu->next()->time), kBegin_ns);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("/imu: its headers have no stamps"), std::string::npos);
}

TEST_F(BagSensorsTest, ASpecificForceInGIsTakenAsSuchAndSaid) {
  std::vector<SentMessage> messages;
  for (int i = 0; i < 5; ++i) messages.push_back({"/imu", "sensor_msgs/msg/Imu", kBegin_ns + i, imu(kBegin_ns + i, 1.0)});
  const Sensors made = sensors(messages);
  EXPECT_NEAR(made.imu->next()->accel_mps2.z(), 9.80665, 1e-9);
  ASSERT_EQ(notes_.size(), 1U);
}

TEST_F(BagSensorsTest, ValuesThatNoSensorGivesAndBytesThatAreNoMessageAreCounted) {
  std::vector<SentMessage> messages{imu_at("/imu", kBegin_ns, kBegin_ns)};
  messages.push_back({"/imu", "sensor_msgs/msg/Imu", kBegin_ns, imu(kBegin_ns, 9.81, NAN)});
  messages.push_back({"/imu", "sensor_msgs/msg/Imu", kBegin_ns, {0, 1, 0, 0, 5}});
  messages.push_back(imu_at("/imu", kBegin_ns + 5 * kMs, kBegin_ns + 5 * kMs));
  const Sensors made = sensors(messages);
  EXPECT_NE(made.imu->next(), nullptr);
  EXPECT_NE(made.imu->next(), nullptr);
  EXPECT_EQ(made.imu->next(), nullptr);
  EXPECT_EQ(made.imu->report().refused(), 2U);
}

TEST_F(BagSensorsTest, FixesSayWhatTheirCovarianceSaysWithinBounds) {
  const std::string type = "sensor_msgs/msg/NavSatFix";
  const Sensors made = sensors({{"/fix", type, kBegin_ns, fix(kBegin_ns, 0, 4.0)},
                                {"/fix", type, kBegin_ns + 1, fix(kBegin_ns + 1, -1, 4.0)},
                                {"/fix", type, kBegin_ns + 2, fix(kBegin_ns + 2, 2, 1e-4)}});
  EXPECT_EQ(made.gnss->next()->sigma_horizontal_m, 2.0);
  EXPECT_EQ(made.gnss->next()->sigma_horizontal_m, 1.0) << "the one without a fix is none, and nobody is believed beyond 1 m";
  EXPECT_EQ(made.gnss->next(), nullptr);
}

class Clouds : public BagSensorsTest, public testing::WithParamInterface<CloudShape> {};

TEST_P(Clouds, AreRevolutionsWhosePointsHaveTheirTimesAndLasers) {
  const CloudShape shape = GetParam();
  std::vector<SentMessage> messages;
  for (int i = 0; i < 5; ++i) {  // stamped at the sweep's begin, recorded at its end
    messages.push_back({"/points", "sensor_msgs/msg/PointCloud2", kBegin_ns + (i + 1) * 100 * kMs, cloud(kBegin_ns + i * 100 * kMs, shape)});
  }
  const Sensors made = sensors(messages);
  ASSERT_NE(made.lidar, nullptr);
  std::size_t points = 0;
  double turned_cdeg = 0.0;
  HostTime last{};
  while (const LidarPacket* packet = made.lidar->next()) {
    EXPECT_GE(packet->time, last);
    last = packet->time;
    EXPECT_LE(packet->time + packet->span, packet->arrival);
    turned_cdeg += packet->azimuth_end_cdeg - packet->azimuth_begin_cdeg;
    for (std::size_t i = 0; i < packet->point_count; ++i, ++points) {
      const LidarPoint& p = packet->points[i];
      const double t_s = to_seconds(packet->time + Duration{p.time_offset_ns} - from_ns<HostTime>(kBegin_ns));
      const double azimuth = (shape.clockwise ? -1.0 : 1.0) * std::fmod(t_s, 0.1) * 20.0 * std::numbers::pi;
      const double error = std::remainder(std::atan2(p.y, p.x) - azimuth, 2.0 * std::numbers::pi);
      EXPECT_NEAR(error, 0.0, 1e-3) << t_s;
      EXPECT_EQ(p.ring, std::lround((std::atan2(p.z, std::hypot(p.x, p.y)) * 180.0 / std::numbers::pi + 15.0) / 2.0));
    }
  }
  EXPECT_EQ(points, 5U * 90 * 16);
  EXPECT_NEAR(turned_cdeg, 5 * 35'990.0, 5 * 4 * 400.0) << "a turn a cloud";
}

INSTANTIATE_TEST_SUITE_P(Shapes, Clouds,
                         testing::Values(CloudShape{}, CloudShape{.with_ring = false}, CloudShape{.with_time = false},
                                         CloudShape{.with_ring = false, .with_time = false, .clockwise = false},
                                         CloudShape{.clockwise = false, .float_seconds = false}));

/// A Velodyne in two-return mode, recorded by a vehicle (tier4/nebula).
TEST(RealBag, GivesEveryPacketOfItsScans) {
  const std::string folder = std::string{SLAMD_SHARED_DATA} + "/vlp16/nebula/1673400471837873222";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recording at " << folder;
  OpenedBag opened = open_bag(folder);
  ASSERT_TRUE(std::holds_alternative<std::unique_ptr<Bag>>(opened));
  BagSensors made = open_sensors(*std::get<std::unique_ptr<Bag>>(opened), {}, {});
  ASSERT_NE(made.sensors.lidar, nullptr);
  EXPECT_EQ(made.sensors.imu, nullptr);
  std::size_t packets = 0, points = 0;
  HostTime last{};
  while (const LidarPacket* packet = made.sensors.lidar->next()) {
    EXPECT_GE(packet->arrival, last);
    last = packet->arrival;
    points += packet->point_count;
    ++packets;
  }
  EXPECT_EQ(packets, 603U) << "three scans of 151 packets of two returns, one of 150";
  EXPECT_GT(points, 50'000U);
  EXPECT_EQ(made.sensors.lidar->report().refused() + made.sensors.lidar->report().missing, 0U);
}

}  // namespace
}  // namespace slamd::replay
