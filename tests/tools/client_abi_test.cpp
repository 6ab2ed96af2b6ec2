// libslamd.so.0 as programs link it, against a real server in this process.

#include <gtest/gtest.h>
#include <slamd/client.h>
#include <slamd/client.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/daemon/server_fixture.hpp"

namespace slamd::test {
namespace {

class ClientAbi : public ServerTest {
 protected:
  void SetUp() override {
    start();
    ASSERT_EQ(slamd_connect(socket_path().c_str(), 60'000, &connection_), SLAMD_OK) << slamd_last_error();
  }
  void TearDown() override { slamd_disconnect(connection_); }

  slamd_connection* connection_ = nullptr;
};

TEST_F(ClientAbi, AgreesOnTheVersionAndSaysTheDaemons) {
  EXPECT_EQ(nlohmann::json::parse(slamd_version(connection_)).at("version"), "1.2.3");
}

TEST_F(ClientAbi, AnswersAreJsonAndErrorsHaveTheDaemonsCodeAndWords) {
  slamd_answer answer{};
  const slamd_request status{"get_status", nullptr, nullptr, nullptr};
  ASSERT_EQ(slamd_call(connection_, &status, &answer), SLAMD_OK);
  EXPECT_TRUE(nlohmann::json::parse(answer.result_json).contains("map"));
  EXPECT_EQ(answer.fd, -1);

  const slamd_request unknown{"no_such_method", "{}", nullptr, nullptr};
  EXPECT_EQ(slamd_call(connection_, &unknown, &answer), -32601);
  EXPECT_NE(std::string{slamd_last_error()}, "");
  EXPECT_EQ(slamd_call(connection_, &status, &answer), SLAMD_OK) << "an error ends nothing";
}

TEST_F(ClientAbi, WrongArgumentsAreToldAndSendNothing) {
  slamd_connection* none = nullptr;
  slamd_answer answer{};
  const slamd_request no_object{"get_map", "[1]", nullptr, nullptr};
  EXPECT_EQ(slamd_call(connection_, &no_object, &answer), SLAMD_USAGE);
  EXPECT_EQ(slamd_call(connection_, nullptr, &answer), SLAMD_USAGE);
  EXPECT_EQ(slamd_connect(socket_path().c_str(), 0, &none), SLAMD_USAGE);
  EXPECT_EQ(slamd_connect("/none/slamd.sock", 1000, &none), SLAMD_NO_CONNECTION);
  EXPECT_EQ(slamd_connect(std::string(200, 'x').c_str(), 1000, &none), SLAMD_NO_CONNECTION);
  EXPECT_EQ(slamd_save_fd(-1, "/none", nullptr, nullptr), SLAMD_USAGE);
  EXPECT_EQ(none, nullptr);
  slamd_disconnect(nullptr);
  slamd_close_page(nullptr);
}

TEST_F(ClientAbi, TheGridOfADaemonThatIsNotPlanarIsTheDaemonsError) {
  client::Connection daemon{socket_path()};
  try {
    (void)daemon.grid();
    FAIL() << "there is no grid";
  } catch (const client::ClientError& error) {
    EXPECT_EQ(error.code(), -32007);
  }
}

class PlanarClient : public ServerTest {};

TEST_F(PlanarClient, TheGridIsTheDaemons) {
  GridStore store;
  store.put({.resolution_m = 0.1, .origin = {1.0, -2.0}, .width = 2, .height = 2, .cells = {-1, 0, 100, 0}}, from_ns<HostTime>(5));
  grid_ = &store;
  start();
  const client::Grid grid = client::Connection{socket_path()}.grid();
  EXPECT_EQ(grid.width, 2U);
  EXPECT_EQ(grid.origin_y_m, -2.0);
  EXPECT_EQ(grid.time_ns, 5);
  EXPECT_EQ(grid.cells, (std::vector<std::int8_t>{-1, 0, 100, 0}));
}

TEST_F(ClientAbi, APoseThatIsToldIsThatOfThePage) {
  constexpr std::uint32_t kReasons = static_cast<std::uint32_t>(StatusReason::kNoImu) |
                                     static_cast<std::uint32_t>(StatusReason::kLidarIncomplete);
  slamd_pose told{}, read{};
  slamd_page* page = nullptr;
  ASSERT_EQ(slamd_open_page(connection_, &page), SLAMD_OK);
  EXPECT_EQ(slamd_read_page(page, &read), 0) << "nothing published so far";
  ASSERT_EQ(slamd_subscribe(connection_, "pose", 1000.0), SLAMD_OK);
  publish(123'456'789'012, TrackingStatus::kDegraded, kReasons);
  ASSERT_EQ(slamd_next_pose(connection_, &told), SLAMD_OK) << slamd_last_error();
  ASSERT_EQ(slamd_read_page(page, &read), 1);
  EXPECT_EQ(std::memcmp(&told, &read, sizeof told), 0);
  EXPECT_EQ(told.host_time_ns, 123'456'789'012);
  EXPECT_EQ(told.utc_offset_ns, SLAMD_UTC_OFFSET_UNKNOWN);
  EXPECT_STREQ(slamd_status_name(told.status), "DEGRADED");
  EXPECT_EQ(told.reasons, kReasons);
  EXPECT_STREQ(slamd_reason_name(told.reasons & -told.reasons), "no_imu");
  EXPECT_STREQ(slamd_reason_name(1U << 31U), "?");
  EXPECT_EQ(slamd_page_starts(page), 1U);
  slamd_close_page(page);
}

TEST_F(ClientAbi, PosesAreTakenInOrderAndOthersStay) {
  ASSERT_EQ(slamd_subscribe(connection_, "status", 4.0), SLAMD_OK);
  ASSERT_EQ(slamd_subscribe(connection_, "pose", 1000.0), SLAMD_OK);
  std::uint64_t last = 0;
  for (int i = 1; i <= 3; ++i) {
    publish(i * 1'000'000'000LL);
    slamd_pose pose{};
    ASSERT_EQ(slamd_next_pose(connection_, &pose), SLAMD_OK);
    EXPECT_GT(pose.sequence, last);
    last = pose.sequence;
  }
  const char *topic = nullptr, *params = nullptr;
  do {
    ASSERT_EQ(slamd_next(connection_, &topic, &params), SLAMD_OK);
  } while (std::string{topic} == "pose");
  EXPECT_STREQ(topic, "status");
  EXPECT_TRUE(nlohmann::json::parse(params).contains("pose"));
  EXPECT_EQ(slamd_unsubscribe(connection_, "pose"), SLAMD_OK);
  EXPECT_EQ(slamd_subscribe(connection_, "weather", 1.0), -32602);
}

TEST_F(ClientAbi, ADescriptorBecomesAFileWholeOrNotAtAll) {
  client::Connection daemon{socket_path(), std::chrono::minutes{1}};
  std::vector<std::string> stages;
  const client::Answer map = daemon.call("get_map", {{"format", "ply"}, {"progress", true}}, [&](const nlohmann::json& told) {
    stages.push_back(told.at("stage"));
  });
  ASSERT_TRUE(map.fd);
  const std::string path = socket_path() + ".ply";
  std::size_t written = 0;
  client::save_fd(map.fd.get(), path, [&](std::size_t bytes) { written = bytes; });
  EXPECT_EQ(std::filesystem::file_size(path), map.result.at("bytes"));
  EXPECT_EQ(written, map.result.at("bytes"));
  try {
    client::save_fd(map.fd.get(), "/none/map.ply");
    FAIL() << "there is no such folder";
  } catch (const client::ClientError& error) {
    EXPECT_EQ(error.code(), client::ClientError::kSystem);
    EXPECT_EQ(std::string{error.what()}, "/none/map.ply: No such file or directory");
  }
}

TEST_F(ClientAbi, APatienceEndsAndADaemonThatLeavesIsNoticed) {
  slamd_connection* hasty = nullptr;
  ASSERT_EQ(slamd_connect(socket_path().c_str(), 1'000, &hasty), SLAMD_OK);
  slamd_pose pose{};
  EXPECT_EQ(slamd_next_pose(hasty, &pose), SLAMD_TIMEOUT) << "it subscribed to nothing";
  server_->stop();
  EXPECT_EQ(slamd_next_pose(hasty, &pose), SLAMD_NO_CONNECTION);
  slamd_disconnect(hasty);
}

}  // namespace
}  // namespace slamd::test
