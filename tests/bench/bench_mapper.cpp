// The back end on a drive of 7,000 keyframes (10 km, laps of 1 km): a keyframe put in, and whole solves with closures and GPS.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "estimator/graph/mapper.hpp"
#include "tests/support/graph_drive.hpp"

namespace slamd {
namespace {

using test::GraphDrive;
using test::ScriptedLoops;

constexpr std::size_t kKeyframes = 7000;
constexpr std::size_t kLap = 700;

const GraphDrive& drive() {
  static const GraphDrive the_drive{{.keyframes = kKeyframes, .keyframes_a_lap = kLap}};
  return the_drive;
}

void insert_keyframes(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times_ms;
  for (auto _ : state) {
    Mapper mapper{{}, nullptr, nullptr};
    times_ms.clear();
    for (const Keyframe& keyframe : drive().keyframes) {
      const auto begin = Clock::now();
      mapper.add(keyframe);
      times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
  }
  std::sort(times_ms.begin(), times_ms.end());
  state.counters["median_ms"] = times_ms[times_ms.size() / 2];
  state.counters["p99_ms"] = times_ms[times_ms.size() * 99 / 100];
  state.counters["max_ms"] = times_ms.back();
}
BENCHMARK(insert_keyframes)->Unit(benchmark::kMillisecond);

/// From odometry alone to the optimum with range(0) closures between laps.
void solve_whole(benchmark::State& state) {
  double iterations = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    auto loops = std::make_unique<ScriptedLoops>();
    const auto closures = static_cast<std::size_t>(state.range(0));
    for (std::size_t k = 0; k < closures; ++k) {
      const std::size_t from = k * (kKeyframes - kLap) / closures;
      loops->now.push_back(drive().closure(from, from + kLap));
    }
    Mapper mapper{{}, std::move(loops), nullptr};
    for (const Keyframe& keyframe : drive().keyframes) mapper.add(keyframe);
    state.ResumeTiming();
    mapper.finish();
    iterations = mapper.solution()->iterations;
  }
  state.counters["iterations"] = iterations;
}
BENCHMARK(solve_whole)->Arg(0)->Arg(1)->Arg(20)->Arg(200)->Arg(1500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slamd
