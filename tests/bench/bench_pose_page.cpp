// Reading and writing the pose page, alone and beside the other side; bar: a read below 100 ns.

#include <benchmark/benchmark.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "daemon/server/protocol/pose_page.hpp"

namespace slamd {
namespace {

void read_page(benchmark::State& state) {
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  writer->write({});
  const std::optional<PosePageReader> reader = PosePageReader::map(writer->fd());
  for (auto _ : state) benchmark::DoNotOptimize(reader->read());
}
BENCHMARK(read_page);

void read_page_while_written_at_200_hz(benchmark::State& state) {
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  writer->write({});
  const std::optional<PosePageReader> reader = PosePageReader::map(writer->fd());
  std::atomic<bool> done{false};
  std::thread thread{[&] {
    while (!done.load()) {
      writer->write({});
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
  }};
  for (auto _ : state) benchmark::DoNotOptimize(reader->read());
  done.store(true);
  thread.join();
}
BENCHMARK(read_page_while_written_at_200_hz);

void write_page(benchmark::State& state) {
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  const PoseSample sample;
  for (auto _ : state) writer->write(sample);
}
BENCHMARK(write_page);

}  // namespace
}  // namespace slamd
