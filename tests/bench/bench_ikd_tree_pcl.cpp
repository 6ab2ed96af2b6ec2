// PCL's k-d tree on the map of bench_ikd_tree.cpp. It is static: each change needs the build that is timed here too.

#include <benchmark/benchmark.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "tests/bench/map_fixture.hpp"

namespace slamd::bench {
namespace {

using PclTree = pcl::KdTreeFLANN<pcl::PointXYZ>;

pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_of(const std::vector<Eigen::Vector3f>& points) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const Eigen::Vector3f& point : points) cloud->emplace_back(point.x(), point.y(), point.z());
  return cloud;
}

void pcl_static_nearest(benchmark::State& state) {
  const MapFixture& map = fixture(static_cast<World>(state.range(1)));
  PclTree tree;
  tree.setInputCloud(cloud_of(map.points));
  const auto k = static_cast<unsigned>(state.range(0));
  pcl::Indices indices(k);
  std::vector<float> d2(k);
  for (auto _ : state)
    for (const Eigen::Vector3f& query : map.queries)
      benchmark::DoNotOptimize(tree.nearestKSearch({query.x(), query.y(), query.z()}, k, indices, d2));
  state.counters["per_query"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(map.queries.size()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void pcl_static_build(benchmark::State& state) {
  const auto cloud = cloud_of(fixture(static_cast<World>(state.range(0))).points);
  for (auto _ : state) {
    PclTree tree;
    tree.setInputCloud(cloud);
    benchmark::DoNotOptimize(&tree);
  }
}

BENCHMARK(pcl_static_nearest)->ArgsProduct({{1, 5}, {0, 1}})->ArgNames({"k", "uniform"});
BENCHMARK(pcl_static_build)->Arg(0)->Arg(1)->ArgName("uniform")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slamd::bench
