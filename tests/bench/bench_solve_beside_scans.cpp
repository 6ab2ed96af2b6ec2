// Scans through the odometry at the estimator thread's priority, alone and while another thread solves a graph of 7,000
// keyframes over and over, as the mapping thread does beside it.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <thread>

#include "daemon/threads/real_time.hpp"
#include "estimator/graph/mapper.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "tests/support/graph_drive.hpp"
#include "tests/support/synthetic_drive.hpp"

namespace slamd {
namespace {

constexpr double kDrive_s = 30.0;

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_ms() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

double percentile(std::vector<double>& values, double share) {
  std::ranges::sort(values);
  return values.empty() ? 0.0 : values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Whole solves with 200 closures until it is asked to stop.
void solve_on(const std::stop_token& stop, const test::GraphDrive& drive) {
  while (!stop.stop_requested()) {
    auto loops = std::make_unique<test::ScriptedLoops>();
    for (std::size_t from = 0; from < 6'000; from += 30) loops->now.push_back(drive.closure(from, from + 700));
    Mapper mapper{{}, std::move(loops), nullptr};
    for (const Keyframe& keyframe : drive.keyframes) mapper.add(keyframe);
    mapper.finish();
  }
}

struct ScanTimes {
  std::vector<double> wall_ms, processor_ms;
};

/// What a scan takes from the packet that ends it to its posterior.
ScanTimes run_scans() {
  const test::SyntheticDrive drive;
  LidarInertialOdometry odometry{drive.vehicle(), {}};
  ScanTimes times;
  drive.play(
      0.0, kDrive_s, [&](const ImuSample& sample) { odometry.add(sample); },
      [&](const LidarPacket& packet) {
        odometry.add(packet);
        const double wall = wall_ms();
        const double processor = processor_ms();
        const ScanResult* result = odometry.step();
        if (result == nullptr || result->state.status == TrackingStatus::kInitialising) return;
        times.wall_ms.push_back(slamd::wall_ms() - wall);
        times.processor_ms.push_back(slamd::processor_ms() - processor);
      });
  return times;
}

/// range(0): 1 with the other thread.
void scans(benchmark::State& state) {
  const test::GraphDrive graph{{.keyframes = 7'000, .keyframes_a_lap = 700}};
  for (auto _ : state) {
    std::optional<std::jthread> solver;
    if (state.range(0) != 0) solver.emplace([&graph](const std::stop_token& stop) { solve_on(stop, graph); });
    ScanTimes times;
    std::jthread estimator{[&times] {
      [[maybe_unused]] const Result<void> granted = enter_schedule({.name = "estimator", .priority = 40});
      times = run_scans();
    }};
    estimator.join();
    state.counters["wall_p50_ms"] = percentile(times.wall_ms, 0.5);
    state.counters["wall_p99_ms"] = percentile(times.wall_ms, 0.99);
    state.counters["processor_p50_ms"] = percentile(times.processor_ms, 0.5);
    state.counters["processor_p99_ms"] = percentile(times.processor_ms, 0.99);
  }
}
BENCHMARK(scans)->Arg(0)->Arg(1)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace slamd
