#include "daemon/threads/worker.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace slamd {
namespace {

TEST(Worker, RunsItsBodyUnderItsNameUntilAskedToStop) {
  std::atomic<bool> stopped{false};
  std::string name(16, '\0');
  {
    Worker worker{{"slamd-test"}, [&](const std::stop_token& stop) {
                    pthread_getname_np(pthread_self(), name.data(), name.size());
                    while (!stop.stop_requested()) std::this_thread::yield();
                    stopped = true;
                  }};
    EXPECT_TRUE(worker.scheduled());
    EXPECT_FALSE(stopped);
  }
  EXPECT_TRUE(stopped);
  EXPECT_STREQ(name.c_str(), "slamd-test");
}

TEST(Worker, HurriesAThreadWithoutAPriorityAndNoOther) {
  const auto policy_after_hurry = [](int priority) {
    std::atomic<int> policy{-1};
    std::atomic<bool> hurried{false};
    Worker worker{{"slamd-test", priority}, [&](const std::stop_token&) {
                    while (!hurried) std::this_thread::yield();
                    sched_param parameter{};
                    int now = -1;
                    pthread_getschedparam(pthread_self(), &now, &parameter);
                    policy = now * 1000 + parameter.sched_priority;
                  }};
    worker.hurry();
    const bool permitted = static_cast<bool>(worker.scheduled());
    hurried = true;
    while (policy == -1) std::this_thread::yield();
    return permitted ? policy.load() : -1;
  };
  const int of_its_own = policy_after_hurry(7);
  if (of_its_own == -1) GTEST_SKIP() << "SCHED_FIFO is not permitted here";
  EXPECT_EQ(of_its_own, SCHED_FIFO * 1000 + 7);
  EXPECT_EQ(policy_after_hurry(0), SCHED_FIFO * 1000 + 1);
}

TEST(Worker, AnExceptionEndsTheThreadOnlyAndIsReported) {
  Worker worker{{"slamd-test"}, [](const std::stop_token&) { throw std::runtime_error{"broken"}; }};
  while (!worker.failed()) std::this_thread::yield();
  EXPECT_TRUE(worker.failed());
}

TEST(Worker, AScheduleThatIsNotGrantedIsSaidAndTheBodyRunsAllTheSame) {
  std::atomic<bool> ran{false};
  Worker worker{{"slamd-test", 0, 1023}, [&](const std::stop_token&) { ran = true; }};
  ASSERT_FALSE(worker.scheduled());
  EXPECT_STREQ(worker.scheduled().reason(), "no such CPU to pin to");
  while (!ran) std::this_thread::yield();
}

TEST(Worker, StopsWhileItsBodyHasNotYetLookedAtTheStopToken) {
  for (int i = 0; i < 50; ++i) {
    Worker worker{{"slamd-test"}, [](const std::stop_token& stop) {
                    while (!stop.stop_requested()) std::this_thread::yield();
                  }};
    worker.request_stop();
  }
}

TEST(CpuLatency, ALimitIsWrittenAndHeldOpenAndARefusalIsSaid) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("slamd_dma_" + std::to_string(::getpid()));
  std::ofstream{file};
  {
    const Result<UniqueFd> limit = limit_cpu_latency(20, file.c_str());
    ASSERT_TRUE(limit) << limit.reason();
    std::int32_t written = 0;
    EXPECT_TRUE(std::ifstream{file}.read(reinterpret_cast<char*>(&written), sizeof written));
    EXPECT_EQ(written, 20);
  }
  std::filesystem::remove(file);
  const Result<UniqueFd> refused = limit_cpu_latency(20, file.c_str());
  ASSERT_FALSE(refused);
  EXPECT_NE(std::string{refused.reason()}.find("udev"), std::string::npos);
}

}  // namespace
}  // namespace slamd
