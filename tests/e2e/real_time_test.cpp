// The real app in this process, fed by slam-sim over loopback and ptys: after warm-up its real-time threads neither
// allocate nor lock nor touch a page that is not there, also while all is recorded.

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "daemon/app.hpp"
#include "tests/support/live_simulator.hpp"
#include "tests/support/thread_accounting.hpp"

namespace slamd {
namespace {

using test::LiveSimulator;
using test::TemporaryFolder;

Config config_in(const TemporaryFolder& folder) {
  Config config;
  config.lidar.bind_address = "127.0.0.1";
  config.lidar.port = test::free_udp_port();
  config.lidar.position_port = test::free_udp_port();
  config.imu.source.serial.path = folder.file("imu");
  config.gnss.serial.path = folder.file("gnss");
  config.server.socket_path = folder.file("slamd.sock");
  config.server.save_dir = folder.file("");
  config.real_time.lock_memory = false;  // the test does that, whatever RLIMIT_MEMLOCK says
  return config;
}

LiveSimulator simulator_for(const Config& config) {
  return LiveSimulator{{SLAMD_SLAM_SIM, "--live", "--quiet", "--duration", "180", "--rest", "3", "--udp-host", "127.0.0.1",
                        "--lidar-port", std::to_string(config.lidar.port),
                        "--position-port", std::to_string(config.lidar.position_port),
                        "--imu-pty", config.imu.source.serial.path, "--gps-pty", config.gnss.serial.path}};
}

bool thread_runs(const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator{"/proc/self/task"}) {
    std::string line;
    std::getline(std::ifstream{task.path() / "comm"} >> std::ws, line);
    if (line == name) return true;
  }
  return false;
}

/// Looks at the app every tenth of a second until `done` or three minutes have passed.
template <class Done>
bool supervise_until(App& app, const Done& done) {
  for (int i = 0; i < 1'800; ++i) {
    if (done()) return true;
    if (!app.supervise()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
  }
  return false;
}

TEST(RealTime, ThreadsNeitherAllocateNorLockNorFaultAfterWarmUp) {
  if (!thread_accounting_works()) GTEST_SKIP() << "the sanitizer has its own allocator";
  constexpr std::uint64_t kWarmUpScans = 80;
  constexpr std::uint64_t kCountedScans = 150;
  const TemporaryFolder folder;
  const Config config = config_in(folder);
  keep_stacks_small();
  const bool locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!locked) std::puts("memory cannot be locked here: page faults are not judged");
  auto app = App::open(config, "test", folder.file("recording"));
  ASSERT_TRUE(app) << app.reason();
  const LiveSimulator simulator = simulator_for(config);
  ASSERT_TRUE(simulator.started());
  ASSERT_TRUE((*app)->start());
  ASSERT_TRUE(supervise_until(**app, [&] { return (*app)->scans() >= kWarmUpScans; }));

  const std::vector<std::string> names{"slamd-lidar", "slamd-imu", "slamd-gnss", "slamd-estimator"};
  std::vector<ThreadAccount> before;
  for (const std::string& name : names) before.push_back(thread_account(name));
  const std::uint64_t scans_before = (*app)->scans();
  ASSERT_TRUE(supervise_until(**app, [&] { return (*app)->scans() >= scans_before + kCountedScans; }));
  EXPECT_GT((*app)->keyframes(), 5U) << "the vehicle should have moved while it was counted";

  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_TRUE(thread_runs(names[i])) << names[i];
    const ThreadAccount after = thread_account(names[i]);
    EXPECT_EQ(after.allocations - before[i].allocations, 0U) << names[i];
    EXPECT_EQ(after.frees - before[i].frees, 0U) << names[i];
    EXPECT_EQ(after.locks - before[i].locks, 0U) << names[i];
    if (!locked) continue;
    EXPECT_EQ(after.minor_faults - before[i].minor_faults, 0U) << names[i];
    EXPECT_EQ(after.major_faults - before[i].major_faults, 0U) << names[i];
  }
  (*app)->stop();
}

}  // namespace
}  // namespace slamd
