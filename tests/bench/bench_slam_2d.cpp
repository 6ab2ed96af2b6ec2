// What planar SLAM takes for a scan of 360 beams in a room, without and with the search, and for a snapshot of the grid.

#include <benchmark/benchmark.h>

#include "estimator/grid/slam_2d.hpp"
#include "tests/estimator/planar_room.hpp"

namespace slamd {
namespace {

PlanarPose on_the_way(int scan) { return {{0.02 * (scan % 100) - 1.0, 0.2}, 0.01 * (scan % 100)}; }

/// wheels: false = the motion has to be guessed
void run(benchmark::State& state, bool wheels) {
  std::mt19937_64 rng{1};
  std::vector<LaserScan> scans;
  for (int i = 0; i < 100; ++i) {
    scans.push_back(test::laser_scan(test::room(), on_the_way(i), HostTime{from_seconds(1.0 + 0.2 * i)}, 0.01, rng));
  }
  for (auto _ : state) {
    Slam2d slam{VehicleGeometry{}, Slam2dConfig{}};
    for (int i = 0; i < 100; ++i) {
      const PlanarPose T = on_the_way(i);
      const HostTime time = scans[static_cast<std::size_t>(i)].time;
      if (wheels) slam.add(WheelOdometry{time, time, T.translation.x(), T.translation.y(), T.yaw_rad});
      benchmark::DoNotOptimize(slam.add(scans[static_cast<std::size_t>(i)]));
    }
  }
  state.counters["scans"] = benchmark::Counter(100.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void WithWheels(benchmark::State& state) { run(state, true); }
void WithoutWheels(benchmark::State& state) { run(state, false); }
BENCHMARK(WithWheels)->Unit(benchmark::kMillisecond);
BENCHMARK(WithoutWheels)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slamd
