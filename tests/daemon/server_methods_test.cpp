#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <fstream>

#include "daemon/server/host_clock.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "tests/daemon/server_fixture.hpp"

namespace slamd::test {
namespace {

using nlohmann::json;
namespace error = protocol::error;

std::string content_of(int fd) {
  struct stat status {};
  ::fstat(fd, &status);
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  EXPECT_EQ(::pread(fd, text.data(), text.size(), 0), status.st_size);
  return text;
}

class ServerMethods : public ServerTest {};

TEST_F(ServerMethods, ASocketThatWasHandedOverIsServedAndLeftInItsPlace) {
  UniqueFd listening{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_path().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(listening.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(listening.get(), 8), 0);
  RawClient early = connect();  // before there is a server: it waits, it is not refused
  server_ = std::make_unique<Server>(config(), sources(), "1.2.3");
  ASSERT_TRUE(server_->start(std::move(listening)));
  EXPECT_EQ(early.call(1, "version").at("result").at("daemon"), "slamd");
  server_->stop();
  EXPECT_TRUE(std::filesystem::exists(socket_path())) << "it belongs to whoever made it";
}

TEST_F(ServerMethods, InjectTurnsASensorsSwitchForATimeWhereItIsAllowed) {
  FaultBoard board;
  faults_ = &board;
  start();
  RawClient client = connect();
  const auto played = client.call(1, "inject", {{"sensor", "imu"}, {"verb", "stuck"}, {"for_s", 60}}).at("result");
  EXPECT_EQ(played.at("verb"), "stuck");
  EXPECT_EQ(board.imu.verb(host_now()), FaultVerb::kStuck);
  EXPECT_GT(board.imu.seconds_left(host_now()), 30.0);
  EXPECT_EQ(board.lidar.verb(host_now()), FaultVerb::kNone);
  EXPECT_TRUE(client.call(2, "inject", {{"sensor", "imu"}, {"verb", "none"}}).contains("result"));
  EXPECT_EQ(board.imu.verb(host_now()), FaultVerb::kNone);
  EXPECT_EQ(client.call(3, "inject", {{"verb", "explode"}}).at("error").at("code"), protocol::error::kInvalidParams);
}

TEST_F(ServerMethods, InjectIsRefusedWhereTheConfigurationDoesNotAllowIt) {
  start();
  const auto refused = connect().call(1, "inject", {{"sensor", "imu"}, {"verb", "off"}}).at("error");
  EXPECT_EQ(refused.at("code"), protocol::error::kNotConfigured);
}

TEST_F(ServerMethods, ADescriptorThatIsNoListeningSocketIsAFailedStart) {
  Server server{config(), sources(), "1.2.3"};
  EXPECT_FALSE(server.start(UniqueFd{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)}));
  EXPECT_FALSE(server.start(UniqueFd{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)})) << "it does not listen";
}

TEST_F(ServerMethods, ANewConfigurationHoldsForTheNextRequestAndTheNextClient) {
  start();
  RawClient first = connect();
  EXPECT_TRUE(first.call(1, "version").contains("result"));
  ServerConfig tighter = config();
  tighter.limits.max_clients = 1;
  server_->reconfigure(tighter);
  RawClient second = connect();
  EXPECT_EQ(second.receive()->at("error").at("code"), error::kBusy);
}

TEST_F(ServerMethods, VersionTellsItsNumbersAndRefusesProtocolsThatItDoesNotSpeak) {
  start();
  RawClient client = connect();
  const json result = client.call(1, "version", {{"protocol", 1}}).at("result");
  EXPECT_EQ(result.at("daemon"), "slamd");
  EXPECT_EQ(result.at("version"), "1.2.3");
  EXPECT_EQ(result.at("protocol"), protocol::kVersion);
  EXPECT_EQ(client.call(2, "version", {{"protocol", 99}}).at("error").at("code"), error::kVersionUnknown);
}

TEST_F(ServerMethods, GetPoseIsAnErrorUntilThereIsOneAndThenTheNewest) {
  start();
  RawClient client = connect();
  EXPECT_EQ(client.call(1, "get_pose").at("error").at("code"), error::kNotYet);
  publish(1'000'000'000);
  publish(2'000'000'000, TrackingStatus::kDegraded, bit(StatusReason::kNoImu) | bit(StatusReason::kReset));
  const json pose = client.call(2, "get_pose").at("result");
  EXPECT_EQ(pose.at("time_ns"), 2'000'000'000);
  EXPECT_EQ(pose.at("sequence"), 2);
  EXPECT_EQ(pose.at("status"), "DEGRADED");
  EXPECT_EQ(pose.at("reasons"), json::parse(R"(["no_imu", "reset"])"));
  EXPECT_EQ(pose.at("T_odom_base").at("translation_m"), json::parse("[2.0, 2.0, 3.0]"));
  EXPECT_EQ(pose.at("T_map_base").at("rotation_quat_xyzw"), json::parse("[0.0, 0.0, 0.0, 1.0]"));
  EXPECT_EQ(pose.at("covariance").at(0), 0.25);
  EXPECT_EQ(pose.at("covariance").at(1), 0.0);
  EXPECT_TRUE(pose.at("utc_offset_ns").is_null());
}

TEST_F(ServerMethods, GetStatusShowsSourcesRingsStagesAndStores) {
  SpscRing<int> ring{4};
  Histogram scan;
  scan.record(std::chrono::milliseconds{5});
  health_.add_source("lidar", [] {
    return SourceHealth{.last_arrival = from_ns<HostTime>(1), .received = 10, .lost = 2, .device = "udp",
                        .state = "healthy", .rejected = {{"bad_size", 3}}};
  });
  health_.add_ring("lidar", [&ring] { return ring.counts(); });
  health_.add_stage("scan", scan);
  health_.add_count("scans", [] { return std::uint64_t{17}; });
  add_keyframe(0, 50);
  start();
  RawClient client = connect();
  const json status = client.call(1, "get_status").at("result");
  EXPECT_EQ(status.at("pose").at("status"), "INITIALISING");
  EXPECT_EQ(status.at("health").at("sources").at("lidar").at("rejected").at("bad_size"), 3);
  EXPECT_EQ(status.at("health").at("sources").at("lidar").at("lost"), 2);
  EXPECT_EQ(status.at("health").at("rings").at("lidar").at("capacity"), 4);
  EXPECT_NEAR(status.at("health").at("stages_ms").at("scan").at("p50").get<double>(), 5.0, 0.1);
  EXPECT_EQ(status.at("health").at("counts").at("scans"), 17);
  EXPECT_GT(status.at("health").at("memory").at("resident_bytes").get<double>(), 0.0);
  EXPECT_EQ(status.at("map").at("points"), 50);
  EXPECT_EQ(status.at("server").at("clients"), 1);
}

OccupancyGrid grid_of(std::uint32_t width, std::int8_t cell) {
  return {.resolution_m = 0.05, .origin = {-2.0, 1.5}, .width = width, .height = 2, .cells = std::vector<std::int8_t>(2 * width, cell)};
}

TEST_F(ServerMethods, TheGridComesSealedWithItsPlace) {
  GridStore store;
  grid_ = &store;
  start();
  RawClient client = connect();
  EXPECT_EQ(client.call(1, "get_grid").at("error").at("code"), error::kNotYet);
  store.put(grid_of(4, kFreeCell), from_ns<HostTime>(77));
  store.put(grid_of(3, kOccupiedCell), from_ns<HostTime>(99));
  const json told = client.call(2, "get_grid").at("result");
  EXPECT_EQ(told.at("changes"), 2);
  EXPECT_EQ(told.at("time_ns"), 99);
  EXPECT_EQ(told.at("origin_m"), (json{-2.0, 1.5}));
  EXPECT_EQ(told.at("width").get<int>() * told.at("height").get<int>(), told.at("bytes").get<int>());
  UniqueFd fd = client.take_fd();
  EXPECT_EQ(content_of(fd.get()), std::string(6, static_cast<char>(kOccupiedCell)));
  EXPECT_EQ(::ftruncate(fd.get(), 0), -1) << "nobody can change it";

  const json picture = client.call(3, "get_grid", {{"format", "pgm"}, {"name", "hall.pgm"}}).at("result");
  EXPECT_NE(picture.at("yaml").get<std::string>().find("image: hall.pgm\n"), std::string::npos);
  EXPECT_EQ(content_of(client.take_fd().get()).substr(0, 3), "P5\n");
  EXPECT_EQ(client.call(4, "get_grid", {{"name", "../hall.pgm"}}).at("error").at("code"), error::kRefused);
}

TEST_F(ServerMethods, WithoutPlanarModeThereIsNoGrid) {
  start();
  RawClient client = connect();
  EXPECT_EQ(client.call(1, "get_grid").at("error").at("code"), error::kNotConfigured);
  EXPECT_EQ(client.call(2, "subscribe", {{"topic", "grid"}}).at("error").at("code"), error::kNotConfigured);
}

TEST_F(ServerMethods, GridSubscribersHearOfEachNewGridOnce) {
  GridStore store;
  grid_ = &store;
  store.put(grid_of(1, kFreeCell), from_ns<HostTime>(1));
  start();
  RawClient client = connect();
  ASSERT_TRUE(client.call(1, "subscribe", {{"topic", "grid"}, {"rate_hz", 4.0}}).contains("result"));
  json told = client.receive().value();
  EXPECT_EQ(told.at("method"), "grid");
  EXPECT_EQ(told.at("params").at("changes"), 1);
  EXPECT_FALSE(told.at("params").contains("fd"));
  store.put(grid_of(2, kFreeCell), from_ns<HostTime>(2));
  told = client.receive().value();
  EXPECT_EQ(told.at("params").at("changes"), 2) << "the old one is not told again";
  EXPECT_EQ(told.at("params").at("width"), 2);
  client.call(2, "unsubscribe", {{"topic", "grid"}});
  store.put(grid_of(3, kFreeCell), from_ns<HostTime>(3));
  const std::uint64_t beats = server_->heartbeats();
  while (server_->heartbeats() < beats + 3) ::usleep(10'000);
  client.request(3, "version");
  EXPECT_EQ(client.receive().value().at("id"), 3) << "nothing came before";
}

TEST_F(ServerMethods, PoseSubscriptionSendsAtTheAskedRateUntilUnsubscribed) {
  start();
  RawClient client = connect();
  EXPECT_EQ(client.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 50}}).at("result").at("rate_hz"), 50.0);
  constexpr std::int64_t kPeriod_ns = 5'000'000;
  std::vector<std::int64_t> times;
  for (int i = 1; i <= 40; ++i) {  // 200 Hz; one at a time, so that the server sees each of them
    publish(i * kPeriod_ns);
    if (i % 4 != 1) continue;
    const std::optional<json> line = client.receive();
    ASSERT_TRUE(line);
    EXPECT_EQ(line->at("method"), "pose");
    times.push_back(line->at("params").at("time_ns").get<std::int64_t>());
  }
  ASSERT_EQ(times.size(), 10U);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GE(times[i] - times[i - 1], 3 * kPeriod_ns);
  EXPECT_TRUE(client.call(2, "unsubscribe", {{"topic", "pose"}}).contains("result"));
  publish(41 * kPeriod_ns);
  EXPECT_TRUE(client.call(3, "version").contains("result"));
}

TEST_F(ServerMethods, StatusSubscribersHearOfAChangeAtOnce) {
  start();
  RawClient client = connect();
  client.call(1, "subscribe", {{"topic", "status"}, {"rate_hz", 0.01}});
  ASSERT_EQ(client.receive()->at("method"), "status");
  publish(1'000'000'000, TrackingStatus::kLost, bit(StatusReason::kFewInliers));
  const std::optional<json> line = client.receive();
  ASSERT_TRUE(line);
  EXPECT_EQ(line->at("params").at("pose").at("status"), "LOST");
  EXPECT_EQ(line->at("params").at("pose").at("reasons"), json::parse(R"(["few_inliers"])"));
}

TEST_F(ServerMethods, GetMapHandsOverASealedPcd) {
  for (std::uint64_t id = 0; id < 5; ++id) add_keyframe(id, 300);
  start();
  RawClient client = connect();
  const json box = {{"min_m", {0, 0, 0}}, {"max_m", {9.5, 100, 100}}};
  const json result = client.call(1, "get_map", {{"voxel_size_m", 0.5}, {"box", box}}).at("result");
  EXPECT_EQ(result.at("points"), 30);
  EXPECT_EQ(result.at("keyframes"), 5);
  EXPECT_EQ(result.at("fd"), true);
  const UniqueFd fd = client.take_fd();
  ASSERT_TRUE(fd);
  const std::string pcd = content_of(fd.get());
  EXPECT_EQ(pcd.size(), result.at("bytes").get<std::size_t>());
  EXPECT_NE(pcd.find("POINTS 30\n"), std::string::npos);
  EXPECT_LT(::pwrite(fd.get(), "x", 1, 0), 0) << "sealed";
}

TEST_F(ServerMethods, GetPosePageHandsOverAPageThatFollowsThePose) {
  start();
  RawClient client = connect();
  EXPECT_EQ(client.call(1, "get_pose_page").at("result").at("version"), PosePageLayout::kVersion);
  const UniqueFd fd = client.take_fd();
  const std::optional<PosePageReader> page = PosePageReader::map(fd.get());
  ASSERT_TRUE(page);
  EXPECT_FALSE(page->read());
  publish(5'000'000'000);
  ASSERT_TRUE(page->read());
  EXPECT_EQ(page->read()->host_time_ns, 5'000'000'000);
  EXPECT_EQ(page->read()->map_position_m[0], 5.0);
}

TEST_F(ServerMethods, GetTrajectoryGivesFewPosesAsJsonAndAllAsTum) {
  for (int i = 1; i <= 500; ++i) trajectory_.add(from_ns<HostTime>(i * 100'000'000LL), Pose{});
  start();
  RawClient client = connect();
  const json few = client.call(1, "get_trajectory", {{"max_poses", 3}}).at("result").at("poses");
  ASSERT_EQ(few.size(), 3U);
  EXPECT_EQ(few.at(2).at(0), 50'000'000'000);
  EXPECT_EQ(client.call(2, "get_trajectory", {{"format", "tum"}}).at("result").at("poses"), 500);
  const UniqueFd fd = client.take_fd();
  const std::string text = content_of(fd.get());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 500);
}

TEST_F(ServerMethods, SaveMapWritesIntoTheConfiguredFolderOnly) {
  add_keyframe(0, 100);
  start();
  RawClient client = connect();
  const json result = client.call(1, "save_map", {{"name", "campus.ply"}}).at("result");
  EXPECT_EQ(result.at("path"), folder_ + "/campus.ply");
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/campus.ply"));
  int id = 2;
  for (const char* name : {"../x.pcd", "/tmp/x.pcd", "a/b.pcd", ".hidden.pcd", "x.txt", "", ".pcd", "a\nb.pcd"}) {
    EXPECT_EQ(client.call(id++, "save_map", {{"name", name}}).at("error").at("code"), error::kRefused) << name;
  }
  std::filesystem::create_directory(folder_ + "/taken.pcd");
  EXPECT_EQ(client.call(id, "save_map", {{"name", "taken.pcd"}}).at("error").at("code"), error::kWriteFailed);
}

TEST_F(ServerMethods, PosesKeepFlowingWhileAMapIsMade) {
  for (std::uint64_t id = 0; id < 300; ++id) add_keyframe(id, 10'000);
  start();
  RawClient watcher = connect();
  watcher.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 1000}});
  RawClient client = connect();
  ASSERT_TRUE(client.request(7, "get_map", {{"voxel_size_m", 0.05}, {"progress", true}}));
  for (int i = 1; i <= 20; ++i) {
    publish(i * 10'000'000);
    ASSERT_EQ(watcher.receive()->at("method"), "pose");
  }
  EXPECT_EQ(client.answer(7).at("result").at("keyframes"), 300);
}

TEST_F(ServerMethods, ARequestWithoutAnIdIsDoneButNotAnswered) {
  start();
  RawClient client = connect();
  client.send("{\"jsonrpc\":\"2.0\",\"method\":\"version\"}\n");
  client.send("{\"jsonrpc\":\"2.0\",\"method\":\"no_such_method\"}\n");
  client.request(5, "version");
  EXPECT_EQ(client.receive()->at("id"), 5);
}

}  // namespace
}  // namespace slamd::test
