#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <fstream>
#include <vector>

#include "daemon/server/protocol/protocol.hpp"
#include "tests/daemon/server_fixture.hpp"

namespace slamd::test {
namespace {

using nlohmann::json;
namespace error = protocol::error;

class ServerLimitsTest : public ServerTest {};

TEST_F(ServerLimitsTest, LinesThatAreNoRequestGetTheErrorThatTheStandardNames) {
  start();
  RawClient client = connect();
  const std::vector<std::pair<std::string, int>> cases{
      {"garbage", error::kParse},
      {"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":", error::kParse},
      {std::string("\xff\xfe\x00\x01", 4), error::kParse},
      {std::string(60'000, '['), error::kParse},
      {std::string(20'000, '[') + std::string(20'000, ']'), error::kInvalidRequest},
      {"17", error::kInvalidRequest},
      {"[]", error::kInvalidRequest},
      {R"([{"jsonrpc":"2.0","id":1,"method":"version"}])", error::kInvalidRequest},
      {R"({"id":1,"method":"version"})", error::kInvalidRequest},
      {R"({"jsonrpc":"1.0","id":1,"method":"version"})", error::kInvalidRequest},
      {R"({"jsonrpc":"2.0","id":[],"method":"version"})", error::kInvalidRequest},
      {R"({"jsonrpc":"2.0","id":1,"method":7})", error::kInvalidRequest},
      {R"({"jsonrpc":"2.0","id":1,"method":"version","params":[1]})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"rm -rf"})", error::kUnknownMethod},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_pose","params":{"nonsense":1}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_map","params":{"voxel_size_m":0}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_map","params":{"voxel_size_m":"1"}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_map","params":{"box":{"min_m":[1,2]}}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_map","params":{"box":{"size":1}}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"topic":"all"}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"rate_hz":1e9}})", error::kInvalidParams},
      {R"({"jsonrpc":"2.0","id":1,"method":"get_trajectory","params":{"max_poses":-1}})", error::kInvalidParams},
  };
  for (const auto& [line, code] : cases) {
    client.send(line + "\n");
    const std::optional<json> answer = client.receive();
    ASSERT_TRUE(answer) << line.substr(0, 80);
    EXPECT_EQ(answer->at("error").at("code"), code) << line.substr(0, 80);
  }
  EXPECT_TRUE(client.call(9, "version").contains("result")) << "and the connection still works";
}

TEST_F(ServerLimitsTest, ARequestMayComeByteByByteAndManyInOnePiece) {
  start();
  RawClient client = connect();
  const std::string line = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"version\"}\n";
  for (const char byte : line) client.send({&byte, 1});
  EXPECT_TRUE(client.answer(1).contains("result"));
  std::string many = "\r\n\n";
  for (int i = 2; i < 40; ++i) many += "{\"jsonrpc\":\"2.0\",\"method\":\"version\",\"id\":" + std::to_string(i) + "}\r\n";
  client.send(many);
  for (int i = 2; i < 40; ++i) EXPECT_EQ(client.receive()->at("id"), i);
}

TEST_F(ServerLimitsTest, ATooLongLineIsRefusedAndItsSenderDropped) {
  start();
  for (const bool with_end : {false, true}) {
    RawClient client = connect();
    client.send(std::string(100'000, 'x') + (with_end ? "\n" : ""));
    const std::optional<json> answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->at("error").at("code"), error::kTooLong);
    EXPECT_TRUE(client.hung_up());
  }
  EXPECT_EQ(wait_for_count("too_long", 2), 2U);
}

TEST_F(ServerLimitsTest, TwoHundredClientsAreServedAndOneTooManyIsToldSo) {
  start({.max_clients = 200});
  std::vector<RawClient> clients;
  for (int i = 0; i < 200; ++i) {
    clients.push_back(connect());
    ASSERT_TRUE(clients.back().connected());
    ASSERT_TRUE(clients.back().request(i, "subscribe", {{"topic", "pose"}, {"rate_hz", 200}}));
  }
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(clients[static_cast<std::size_t>(i)].answer(i).contains("result"));
  RawClient refused = connect();
  const std::optional<json> answer = refused.receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->at("error").at("code"), error::kBusy);
  EXPECT_TRUE(refused.hung_up());
  for (int i = 1; i <= 5; ++i) {
    publish(i * 1'000'000'000LL);
    for (RawClient& client : clients) {
      const std::optional<json> line = client.receive();
      ASSERT_TRUE(line);
      EXPECT_EQ(line->at("params").at("sequence"), i);
    }
  }
  clients.erase(clients.begin() + 100, clients.end());
  for (int i = 0; i < 2000 && server_->clients() != 100; ++i) ::usleep(10'000);
  EXPECT_EQ(server_->clients(), 100U) << "those who left are forgotten";
}

TEST_F(ServerLimitsTest, AClientThatNeverReadsLosesItsOwnMessagesOnlyAndIsDropped) {
  start({.stall_timeout_s = 0.5});
  RawClient deaf = connect();
  RawClient healthy = connect();
  ASSERT_TRUE(deaf.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 1000}}).contains("result"));
  healthy.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 1000}});
  int published = 0;
  while (server_->clients() == 2 && published < 200'000) {
    publish(++published * 10'000'000LL);
    ASSERT_EQ(healthy.receive()->at("params").at("sequence"), published) << "the other one misses nothing";
  }
  EXPECT_EQ(server_->clients(), 1U);
  EXPECT_EQ(wait_for_count("stalled_clients", 1), 1U);
  EXPECT_TRUE(deaf.hung_up());
}

/// Bytes that the daemon has sent and the client has not read.
int unread_bytes(const RawClient& client) {
  int bytes = 0;
  return ::ioctl(client.fd(), FIONREAD, &bytes) == 0 ? bytes : -1;
}

TEST_F(ServerLimitsTest, WhoLeavesDescriptorsUntakenGetsNoMoreUntilItTakesThem) {
  start();
  RawClient hoarder = connect();
  constexpr int kPages = 40;  // below the burst of requests that is served without a pause
  for (int i = 0; i < kPages; ++i) ASSERT_TRUE(hoarder.request(i, "get_pose_page"));
  RawClient other = connect();
  const std::size_t answer_bytes = other.call(0, "get_pose_page").dump().size() + 1;
  for (int i = 1; i <= 5; ++i) other.call(i, "version");  // the hoarder has had its turns between them
  EXPECT_LE(unread_bytes(hoarder), static_cast<int>(2 * answer_bytes + 10));
  for (int i = 0; i < kPages; ++i) {
    ASSERT_TRUE(hoarder.answer(i).contains("result"));
    EXPECT_TRUE(hoarder.take_fd());
  }
}

TEST_F(ServerLimitsTest, AClientThatNeverTakesADescriptorIsDropped) {
  start({.stall_timeout_s = 0.5});
  RawClient deaf = connect();
  ASSERT_TRUE(deaf.request(1, "get_pose_page"));
  RawClient healthy = connect();
  ASSERT_TRUE(healthy.call(1, "get_pose_page").contains("result"));
  EXPECT_EQ(wait_for_count("stalled_clients", 1), 1U);
  EXPECT_TRUE(healthy.call(2, "version").contains("result"));
}

TEST_F(ServerLimitsTest, ASlowClientIsToldHowManyNotificationsItLost) {
  start();
  RawClient slow = connect();
  RawClient pace = connect();
  slow.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 1000}});
  pace.call(1, "subscribe", {{"topic", "pose"}, {"rate_hz", 1000}});
  constexpr int kSamples = 3000;  // several times what the socket and the outbox hold
  for (int i = 1; i <= kSamples; ++i) {
    publish(i * 10'000'000LL);
    ASSERT_TRUE(pace.receive());
  }
  int sequence = 0;
  int received = 0;
  std::optional<json> line;
  while (sequence < kSamples && (line = slow.receive()) && line->at("method") == "pose") {
    sequence = line->at("params").at("sequence").get<int>();
    if (++received % 16 != 0) continue;
    publish((kSamples + received) * 10'000'000LL);  // something new, so that it hears of the loss
    ASSERT_TRUE(pace.receive()) << "of two samples at once only the newer is notified: the count would miss one";
  }
  ASSERT_TRUE(line);
  ASSERT_EQ(line->at("method"), "lost");
  const int next = slow.receive()->at("params").at("sequence").get<int>();
  EXPECT_EQ(line->at("params").at("count"), next - sequence - 1);
  EXPECT_GT(line->at("params").at("count").get<int>(), 100);
}

TEST_F(ServerLimitsTest, AFloodOfRequestsIsAnsweredAtTheAllowedRateAndDisturbsNobody) {
  start({.max_requests_per_s = 50});
  RawClient flooder = connect();
  std::string flood;
  for (int i = 0; i < 60; ++i) flood += "{\"jsonrpc\":\"2.0\",\"method\":\"version\",\"id\":" + std::to_string(i) + "}\n";
  ASSERT_TRUE(flooder.send(flood));
  RawClient other = connect();
  EXPECT_TRUE(other.call(1, "version").contains("result"));
  for (int i = 0; i < 60; ++i) EXPECT_EQ(flooder.receive()->at("id"), i) << "late, but all and in order";
  const json counts = other.call(2, "get_status").at("result").at("server");
  EXPECT_GT(counts.at("throttled").get<int>(), 0);
}

TEST_F(ServerLimitsTest, JobsBeyondTheLimitAreRefused) {
  for (std::uint64_t id = 0; id < 200; ++id) add_keyframe(id, 10'000);
  start({.max_jobs = 1});
  RawClient first = connect();
  RawClient second = connect();
  first.request(1, "get_map", {{"voxel_size_m", 0.02}});
  first.request(2, "version");
  const bool done = first.receive()->at("id") == 1;  // else it was the version, and the job has begun
  const json answer = second.call(1, "get_map");
  const bool refused = answer.contains("error") && answer.at("error").at("code") == error::kBusy;
  EXPECT_TRUE(refused || done || first.answer(1).contains("result")) << "refused, unless the first was done already";
}

TEST_F(ServerLimitsTest, AnswersStillComeAfterTheClientShutDownItsSendingSide) {
  add_keyframe(0, 1000);
  start();
  RawClient client = connect();
  client.request(1, "get_map");
  client.shut_down_sending();
  EXPECT_TRUE(client.answer(1).contains("result"));
  EXPECT_TRUE(client.hung_up());
}

TEST_F(ServerLimitsTest, TheSocketIsForOwnerAndGroupOnlyAndGoneAfterTheStop) {
  start();
  struct stat status {};
  ASSERT_EQ(::stat(socket_path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
  server_->stop();
  EXPECT_NE(::stat(socket_path().c_str(), &status), 0);
}

TEST_F(ServerLimitsTest, ASecondInstanceIsRefusedAndTheFirstLivesOn) {
  start();
  Server second{config(), sources(), "1"};
  const Result<void> started = second.start();
  ASSERT_FALSE(started);
  EXPECT_STREQ(started.reason(), "another instance of slamd serves this socket");
  EXPECT_TRUE(connect().call(1, "version").contains("result"));
}

TEST_F(ServerLimitsTest, AStaleSocketIsReplacedButNothingElseIs) {
  {
    const UniqueFd stale{::socket(AF_UNIX, SOCK_STREAM, 0)};
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_path().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(stale.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  start();
  EXPECT_TRUE(connect().call(1, "version").contains("result"));
  server_->stop();
  server_.reset();
  std::ofstream{socket_path()} << "precious";
  Server over_file{config(), sources(), "1"};
  EXPECT_FALSE(over_file.start());
  EXPECT_TRUE(std::filesystem::exists(socket_path()));
}

TEST_F(ServerLimitsTest, PathsThatCannotBeASocketAreClearErrors) {
  ServerConfig too_long = config();
  too_long.socket_path = folder_ + "/" + std::string(200, 'x');
  EXPECT_STREQ(Server(too_long, sources(), "1").start().reason(), "the socket's path is empty or too long");
  ServerConfig nowhere = config();
  nowhere.socket_path = folder_ + "/none/slamd.sock";
  EXPECT_FALSE(Server(nowhere, sources(), "1").start());
}

}  // namespace
}  // namespace slamd::test
