// The incremental k-d tree beside nanoflann's dynamic and static trees on the same LiDAR-like map; PCL's tree is in
// bench_ikd_tree_pcl.cpp. Insert times are per batch of 2,000 points with 0.5 m downsampling.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <nanoflann.hpp>
#include <unordered_set>

#include "estimator/map/ikd_tree.hpp"
#include "tests/bench/map_fixture.hpp"

namespace slamd::bench {
namespace {

constexpr float kMaxDistance = 5.0F;

struct Cloud {
  std::vector<Eigen::Vector3f> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

using Metric = nanoflann::L2_Simple_Adaptor<float, Cloud>;
using DynamicTree = nanoflann::KDTreeSingleIndexDynamicAdaptor<Metric, Cloud, 3>;
using StaticTree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, 3>;

IkdTree tree_of(const std::vector<Eigen::Vector3f>& points) {
  IkdTree tree({.voxel_size_m = kVoxel, .max_points = 400'000});
  std::size_t i = 0;
  for (const Eigen::Vector3f& point : points) {
    tree.insert(point);
    if (++i % kBatch == 0) tree.rebalance(20'000);
  }
  return tree;
}

void report_shape(benchmark::State& state, const IkdTree& tree) {
  state.counters["points"] = static_cast<double>(tree.size());
  state.counters["depth"] = tree.depth();
  state.counters["leaves"] = tree.leaves();
  state.counters["branches"] = tree.branches();
}

void report_queries(benchmark::State& state, std::size_t queries) {
  state.counters["per_query"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(queries),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void ikd_nearest_many(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(1)));
  const IkdTree tree = tree_of(map.points);
  const auto k = static_cast<std::size_t>(state.range(0));
  std::vector<Neighbour> out(map.queries.size() * k);
  std::vector<std::uint8_t> counts(map.queries.size());
  for (auto _ : state) {
    tree.nearest_many(map.queries, k, kMaxDistance, out, counts);
    benchmark::DoNotOptimize(out.data());
  }
  report_queries(state, map.queries.size());
  report_shape(state, tree);
}

void ikd_nearest(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(1)));
  const IkdTree tree = tree_of(map.points);
  std::vector<Neighbour> out(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state)
    for (const Eigen::Vector3f& query : map.queries)
      benchmark::DoNotOptimize(tree.nearest(query, out, std::numeric_limits<float>::infinity()));
  report_queries(state, map.queries.size());
}

template <typename Tree>
void query_nanoflann(benchmark::State& state, const Tree& tree, const std::vector<Eigen::Vector3f>& queries) {
  const auto k = static_cast<std::size_t>(state.range(0));
  std::vector<std::size_t> indices(k);
  std::vector<float> d2(k);
  for (auto _ : state) {
    for (const Eigen::Vector3f& query : queries) {
      nanoflann::KNNResultSet<float> found(k);
      found.init(indices.data(), d2.data());
      benchmark::DoNotOptimize(tree.findNeighbors(found, query.data(), nanoflann::SearchParams()));
    }
  }
  report_queries(state, queries.size());
}

void nanoflann_dynamic_nearest(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(1)));
  Cloud cloud;
  DynamicTree tree(3, cloud);
  for (std::size_t i = 0; i < map.points.size(); i += kBatch) {
    const std::size_t end = std::min(i + kBatch, map.points.size());
    cloud.points.insert(cloud.points.end(), map.points.begin() + static_cast<std::ptrdiff_t>(i),
                        map.points.begin() + static_cast<std::ptrdiff_t>(end));
    tree.addPoints(i, end - 1);
  }
  query_nanoflann(state, tree, map.queries);
}

void nanoflann_static_nearest(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(1)));
  const Cloud cloud{map.points};
  const StaticTree tree(3, cloud);
  query_nanoflann(state, tree, map.queries);
}

void nanoflann_static_build(benchmark::State& state) {
  const Cloud cloud{fixture(static_cast<World>(state.range(0))).points};
  for (auto _ : state) {
    const StaticTree tree(3, cloud);
    benchmark::DoNotOptimize(&tree);
  }
}

double thread_micros() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e6 + static_cast<double>(now.tv_nsec) * 1e-3;
}

/// Times each batch alone, in the thread's processor time so that other programs on a shared machine do not count:
/// median, 99th percentile and worst.
template <typename Insert>
void time_batches(benchmark::State& state, const std::vector<std::vector<Eigen::Vector3f>>& batches, Insert insert) {
  std::vector<double> micros;
  for (const auto& batch : batches) {
    const double start = thread_micros();
    insert(batch);
    micros.push_back(thread_micros() - start);
  }
  std::sort(micros.begin(), micros.end());
  state.counters["us_median"] = micros[micros.size() / 2];
  state.counters["us_p99"] = micros[micros.size() * 99 / 100];
  state.counters["us_worst"] = micros.back();
}

void ikd_insert(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(0)));
  for (auto _ : state) {
    IkdTree tree = tree_of(map.points);
    time_batches(state, map.batches, [&tree](const std::vector<Eigen::Vector3f>& batch) {
      for (const Eigen::Vector3f& point : batch) tree.insert(point);
      tree.rebalance(4'000);
    });
    report_shape(state, tree);
    state.counters["rebuilt"] = static_cast<double>(tree.stats().rebuilt_points);
    state.counters["regrown"] = static_cast<double>(tree.stats().regrown);
  }
}

void nanoflann_dynamic_insert(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(0)));
  for (auto _ : state) {
    Cloud cloud;
    cloud.points.reserve(1'000'000);
    DynamicTree tree(3, cloud);
    std::unordered_set<std::uint64_t> voxels;
    const auto insert = [&](const std::vector<Eigen::Vector3f>& batch) {
      const std::size_t first = cloud.points.size();
      for (const Eigen::Vector3f& point : batch)
        if (voxels.insert(voxel_key(point)).second) cloud.points.push_back(point);
      if (cloud.points.size() > first) tree.addPoints(first, cloud.points.size() - 1);
    };
    for (std::size_t i = 0; i < map.points.size(); i += kBatch)
      insert({map.points.begin() + static_cast<std::ptrdiff_t>(i),
              map.points.begin() + static_cast<std::ptrdiff_t>(std::min(i + kBatch, map.points.size()))});
    time_batches(state, map.batches, insert);
  }
}

const std::vector<std::vector<std::int64_t>> kQueryArguments{{1, 5, 8}, {0, 1}};

BENCHMARK(ikd_nearest_many)->ArgsProduct(kQueryArguments)->ArgNames({"k", "uniform"});
BENCHMARK(ikd_nearest)->ArgsProduct(kQueryArguments)->ArgNames({"k", "uniform"});
BENCHMARK(nanoflann_static_nearest)->ArgsProduct({{1, 5}, {0, 1}})->ArgNames({"k", "uniform"});
BENCHMARK(nanoflann_dynamic_nearest)->ArgsProduct({{1, 5}, {0, 1}})->ArgNames({"k", "uniform"});
BENCHMARK(ikd_insert)->Arg(0)->Arg(1)->ArgName("uniform")->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(nanoflann_dynamic_insert)->Arg(0)->Arg(1)->ArgName("uniform")->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(nanoflann_static_build)->Arg(0)->Arg(1)->ArgName("uniform")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slamd::bench

BENCHMARK_MAIN();
