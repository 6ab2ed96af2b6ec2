#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

#include "daemon/server/peer.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "tests/daemon/server_fixture.hpp"

namespace slamd::test {
namespace {

constexpr gid_t kGroup = 4711;
constexpr uid_t kDaemon = 900;

TEST(ControlGroup, MembersRootAndTheDaemonsUserControlAndNobodyElse) {
  EXPECT_TRUE(may_control(Peer{1000, {1000, kGroup}}, kGroup, kDaemon));
  EXPECT_TRUE(may_control(Peer{1000, {kGroup}}, kGroup, kDaemon));
  EXPECT_TRUE(may_control(Peer{0, {}}, kGroup, kDaemon));
  EXPECT_TRUE(may_control(Peer{kDaemon, {}}, kGroup, kDaemon));
  EXPECT_FALSE(may_control(Peer{1000, {1000, kGroup + 1}}, kGroup, kDaemon));
  EXPECT_FALSE(may_control(std::nullopt, kGroup, kDaemon));
}

TEST(ControlGroup, ThePeerOfASocketHasThisProcessesUserAndGroups) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  const UniqueFd one{ends[0]};
  const UniqueFd other{ends[1]};
  const std::optional<Peer> peer = peer_of(one.get());
  ASSERT_TRUE(peer);
  EXPECT_EQ(peer->user, ::geteuid());
  EXPECT_EQ(peer->groups.back(), ::getegid());
  EXPECT_EQ(peer->groups.size(), static_cast<std::size_t>(::getgroups(0, nullptr)) + 1);
}

class ControlGroupServer : public ServerTest {
 protected:
  void start_with(const std::string& group) {
    ServerConfig with_group = config();
    with_group.control_group = group;
    server_ = std::make_unique<Server>(with_group, sources(), "1.2.3");
    const Result<void> started = server_->start();
    ASSERT_TRUE(started) << started.reason();
    ASSERT_EQ(::chmod(folder_.c_str(), 0755), 0);
    ASSERT_EQ(::chmod(socket_path().c_str(), 0666), 0);
  }

  /// Connects on a thread of another user: credentials are a thread's own when libc does not spread them.
  std::optional<RawClient> connect_as(uid_t user, std::vector<gid_t> groups) {
    std::optional<RawClient> client;
    std::thread{[&] {
      const bool changed = ::syscall(SYS_setgroups, groups.size(), groups.data()) == 0 &&
                           ::syscall(SYS_setresgid, user, user, user) == 0 &&
                           ::syscall(SYS_setresuid, user, user, user) == 0;
      if (changed) client.emplace(socket_path());
    }}.join();
    return client;
  }
};

TEST_F(ControlGroupServer, WithoutTheGroupAClientReadsAndIsRefusedWhatWrites) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to connect as other users";
  const group* daemon_group = ::getgrnam("daemon");
  ASSERT_NE(daemon_group, nullptr);
  const gid_t control = daemon_group->gr_gid;
  add_keyframe(0, 100);
  start_with("daemon");
  std::optional<RawClient> stranger = connect_as(54321, {});
  std::optional<RawClient> member = connect_as(54321, {control});
  ASSERT_TRUE(stranger && stranger->connected() && member && member->connected());
  EXPECT_TRUE(stranger->call(1, "get_map").contains("result"));
  const nlohmann::json refused = stranger->call(2, "save_map").at("error");
  EXPECT_EQ(refused.at("code"), protocol::error::kNotAllowed);
  EXPECT_EQ(refused.at("message"), "save_map needs a member of the group daemon");
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/map.pcd"));
  EXPECT_EQ(wait_for_count("refused_control", 1), 1U);
  EXPECT_TRUE(member->call(1, "save_map").contains("result"));
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/map.pcd"));
}

TEST_F(ControlGroupServer, AGroupThatTheSystemDoesNotHaveIsAFailedStart) {
  ServerConfig wrong = config();
  wrong.control_group = "no-such-group-here";
  Server server{wrong, sources(), "1.2.3"};
  const Result<void> started = server.start();
  ASSERT_FALSE(started);
  EXPECT_STREQ(started.reason(), "server.control_group: the system has no such group");
}

}  // namespace
}  // namespace slamd::test
