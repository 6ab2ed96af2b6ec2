// The rings and the estimator's thread at ten times the sensors' rate: nothing is dropped.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <numeric>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/estimator_thread.hpp"
#include "daemon/threads/pause.hpp"
#include "daemon/threads/spatial_front_end.hpp"
#include "daemon/threads/worker.hpp"

namespace slamd {
namespace {

constexpr Duration kPacketPeriod = std::chrono::nanoseconds{132'710};  // a tenth of the VLP-16's
constexpr Duration kSamplePeriod = std::chrono::microseconds{500};     // a tenth of the IMU's
constexpr double kDefaultSeconds = 10.0;

/// SLAMD_RING_SECONDS, or ten.
double run_seconds() {
  const char* text = std::getenv("SLAMD_RING_SECONDS");
  return text != nullptr ? std::atof(text) : kDefaultSeconds;
}

/// A room's four walls as seen by one packet, `turned` revolutions after the first.
LidarPacket packet_at(HostTime time, double turned) {
  LidarPacket packet{};
  packet.time = time;
  packet.arrival = time + kPacketPeriod;
  packet.span = kPacketPeriod;
  constexpr double kPacketTurns = 0.01327;
  const auto azimuth_cdeg = [](double turns) {
    return static_cast<std::uint16_t>(std::lround(std::fmod(turns, 1.0) * 36'000.0) % 36'000);
  };
  packet.azimuth_begin_cdeg = azimuth_cdeg(turned);
  packet.azimuth_end_cdeg = azimuth_cdeg(turned + kPacketTurns);
  packet.point_count = 32;
  for (std::size_t i = 0; i < packet.point_count; ++i) {
    const double angle = -2.0 * M_PI * (turned + kPacketTurns * static_cast<double>(i) / packet.point_count);
    const double range_m = 10.0 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    packet.points[i] = {.x = static_cast<float>(range_m * std::cos(angle)),
                        .y = static_cast<float>(range_m * std::sin(angle)),
                        .z = static_cast<float>(0.2 * static_cast<double>(i % 16)),
                        .time_offset_ns = static_cast<std::int32_t>(i * 4'000),
                        .azimuth_cdeg = packet.azimuth_begin_cdeg,
                        .ring = static_cast<std::uint8_t>(i % 16),
                        .intensity = 50,
                        .return_index = 0};
  }
  return packet;
}

ImuSample sample_at(HostTime time) {
  ImuSample sample;
  sample.time = time;
  sample.arrival = time + std::chrono::microseconds{300};
  sample.accel_mps2 = {0.0, 0.0, 9.80665};
  return sample;
}

/// Calls make(n) at its due time, n = 0, 1, ... until run_seconds() have passed; returns how many.
template <class Make>
std::uint64_t at_rate(Duration period, const Make& make) {
  const HostTime begin = host_now();
  std::uint64_t made = 0;
  const Duration run_time = from_seconds(run_seconds());
  for (HostTime now = begin; now - begin < run_time; now = host_now()) {
    for (; begin + static_cast<std::int64_t>(made) * period <= now; ++made) {
      make(begin + static_cast<std::int64_t>(made) * period, made);
    }
    pause_for(std::chrono::milliseconds{1});
  }
  return made;
}

/// How long the calling thread has been ready to run and another ran instead; 0 where the kernel does not count it.
Duration waited_for_cpu() {
  std::int64_t ran_ns = 0;
  std::int64_t waited_ns = 0;
  std::ifstream{"/proc/thread-self/schedstat"} >> ran_ns >> waited_ns;
  return std::chrono::nanoseconds{waited_ns};
}

struct Outcome {
  std::uint64_t packets = 0;
  std::uint64_t samples = 0;
  std::uint64_t scans = 0;
  RingCounts lidar;
  RingCounts imu;
  Duration waited{};  // of all threads

  bool dropped() const { return lidar.dropped + imu.dropped > 0; }
};

Outcome run_at_ten_times_the_rate() {
  const auto streams = std::make_unique<Streams>();
  const auto estimator =
      std::make_unique<EstimatorThread>(
          EstimatorThreadConfig{},
          std::make_unique<SpatialFrontEnd>(SpatialFrontEndConfig{}, VehicleGeometry{}, OdometryConfig{}, *streams), *streams);
  Outcome outcome;
  std::array<Duration, 3> waited{};  // read after the threads were joined
  std::atomic<int> ended{0};
  {
    const Worker consumer{{"estimator", 40}, [&](const std::stop_token& stop) {
                            estimator->run(stop);
                            waited[0] = waited_for_cpu();
                          }};
    const Worker lidar{{"lidar", 50}, [&](const std::stop_token&) {
                         outcome.packets = at_rate(kPacketPeriod, [&](HostTime time, std::uint64_t n) {
                           streams->lidar.try_push(packet_at(time, 0.01327 * static_cast<double>(n)));
                         });
                         waited[1] = waited_for_cpu();
                         ++ended;
                       }};
    const Worker imu{{"imu", 60}, [&](const std::stop_token&) {
                       outcome.samples = at_rate(
                           kSamplePeriod, [&](HostTime time, std::uint64_t) { streams->imu.try_push(sample_at(time)); });
                       waited[2] = waited_for_cpu();
                       ++ended;
                     }};
    const auto busy = [&] { return ended < 2 || streams->lidar.counts().size > 0; };
    while (busy() && !consumer.failed()) pause_for(std::chrono::milliseconds{10});
  }
  outcome.scans = estimator->scans();
  outcome.lidar = streams->lidar.counts();
  outcome.imu = streams->imu.counts();
  outcome.waited = std::reduce(waited.begin(), waited.end());
  return outcome;
}

/// Drops prove something only when the threads had the processor: a ring holds 68 ms of packets at this rate, and waiting
/// for each other takes the threads less than a hundredth of the time.
bool spoilt(const Outcome& outcome) {
  return outcome.dropped() && outcome.waited > 512 * kPacketPeriod + from_seconds(0.01 * run_seconds());
}

TEST(RingRate, TenTimesTheSensorsRateDropsNothing) {
  Outcome outcome = run_at_ten_times_the_rate();
  for (int i = 1; i < 3 && spoilt(outcome); ++i) outcome = run_at_ten_times_the_rate();
  if (spoilt(outcome)) {
    GTEST_SKIP() << "no real time on this machine: the threads waited " << to_seconds(outcome.waited) << " s for a processor";
  }
  EXPECT_GT(static_cast<double>(outcome.packets), 7'000.0 * run_seconds());
  EXPECT_GT(static_cast<double>(outcome.samples), 1'900.0 * run_seconds());
  EXPECT_EQ(outcome.lidar.dropped, 0U);
  EXPECT_EQ(outcome.imu.dropped, 0U);
  EXPECT_EQ(outcome.lidar.pushed, outcome.packets);
  EXPECT_EQ(outcome.imu.pushed, outcome.samples);
  EXPECT_GT(static_cast<double>(outcome.scans), 90.0 * run_seconds());
  RecordProperty("lidar_high_water", static_cast<int>(outcome.lidar.high_water));
  RecordProperty("waited_ms", static_cast<int>(to_seconds(outcome.waited) * 1e3));
}

}  // namespace
}  // namespace slamd
