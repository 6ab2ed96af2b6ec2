// From an IMU frame in the port to its pose on the page, and from a scan's last packet to its pose, in the running daemon beside
// what the machine's scheduler does to a thread of the same priority that only sleeps (as cyclictest measures). Prints a table;
// `run` beside it adds cyclictest and stress-ng of the same minutes.
//     bench_latency [SECONDS]

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <slamd/client.hpp>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "daemon/app.hpp"
#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"
#include "tests/support/live_simulator.hpp"
#include "tools/slam-sim/output/pty_port.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kLidarPort = 23690;
constexpr Duration kPatience = 3ms;  // the next frame comes after 5
constexpr Duration kBareAfter = 1ms; // the bare port's frame: at once it would profit from the worker that has just run
constexpr Duration kWarmUp = 10s;
constexpr const char* kSpeed_mps = "4.5";   // 3 km last for eleven minutes

Config config_in(const test::TemporaryFolder& folder) {
  Config config;
  config.lidar.bind_address = "127.0.0.1";
  config.lidar.port = kLidarPort;
  config.lidar.position_port = kLidarPort + 1;
  config.imu.source.serial.path = folder.file("imu");
  config.gnss.serial.path = folder.file("gnss");
  config.server.socket_path = folder.file("slamd.sock");
  return config;
}

test::LiveSimulator simulator_in(const test::TemporaryFolder& folder, Duration length) {
  return test::LiveSimulator{{SLAMD_SLAM_SIM, "--live", "--quiet", "--scenario", "hills", "--speed", kSpeed_mps, "--rest", "3",
                              "--duration", std::to_string(to_seconds(length)), "--lidar-port", std::to_string(kLidarPort),
                              "--position-port", std::to_string(kLidarPort + 1), "--imu-pty", folder.file("sim-imu"),
                              "--gps-pty", folder.file("gnss")}};
}

/// Wakes every 5 ms like the IMU's thread; records by how much too late.
void measure_sleep(const std::stop_token& stop, Histogram& lateness) {
  HostTime due = host_now();
  while (!stop.stop_requested()) {
    due += 5ms;
    const std::int64_t ns = to_ns(due);
    const timespec wanted{ns / 1'000'000'000, ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr);
    lateness.record(host_now() - due);
  }
}

/// A serial port whose reader does nothing else: what the kernel takes from one end to the other.
class BarePort {
 public:
  explicit BarePort(const std::string& path) : path_{path}, port_{path} {}

  void send(std::span<const std::uint8_t> bytes) {
    sent_ns_.store(to_ns(host_now()), std::memory_order_release);
    port_.write(bytes);
  }

  void read(const std::stop_token& stop, Histogram& latency) {
    const UniqueFd reader{::open(path_.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC)};
    std::array<std::uint8_t, 4096> bytes;
    const HostTime begin = host_now();
    while (!stop.stop_requested()) {
      pollfd ready{reader.get(), POLLIN, 0};
      if (::poll(&ready, 1, 100) <= 0 || ::read(reader.get(), bytes.data(), bytes.size()) <= 0) continue;
      const HostTime now = host_now();
      const HostTime sent = from_ns<HostTime>(sent_ns_.load(std::memory_order_acquire));
      if (now - begin > kWarmUp) latency.record(now - sent);
    }
  }

 private:
  std::string path_;
  sim::PtyPort port_;
  std::atomic<std::int64_t> sent_ns_{0};
};

/// Stands between simulator and daemon on the IMU's cable: passes a frame on and waits until the page has a new pose.
class Relay {
 public:
  Relay(const std::string& from, const std::string& to, BarePort& bare) : to_{to}, bare_{bare}, from_path_{from} {}

  void run(const std::stop_token& stop, client::PosePage& page, Histogram& latency) {
    const HostTime begin = host_now();
    while (!stop.stop_requested()) {
      const std::size_t size = read_frame();
      const std::uint64_t before = sequence(page);
      const HostTime sent = host_now();
      to_.write({bytes_.data(), size});
      if (size == 0) continue;
      while (sequence(page) == before && host_now() - sent < kPatience) pause_for(10us);
      if (host_now() - begin > kWarmUp) latency.record(host_now() - sent);
      pause_for(kBareAfter);
      bare_.send({bytes_.data(), size});
    }
  }

 private:
  static std::uint64_t sequence(const client::PosePage& page) {
    const std::optional<client::Pose> newest = page.read();
    return newest ? newest->sequence : 0;
  }

  std::size_t read_frame() {
    if (!from_) from_ = UniqueFd{::open(from_path_.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC)};
    pollfd ready{from_.get(), POLLIN, 0};
    if (!from_ || ::poll(&ready, 1, 100) <= 0) return 0;
    const ssize_t size = ::read(from_.get(), bytes_.data(), bytes_.size());
    if (size > 0) return static_cast<std::size_t>(size);
    pause_for(1ms);  // nobody at the other end
    return 0;
  }

  sim::PtyPort to_;
  BarePort& bare_;
  std::string from_path_;
  UniqueFd from_;
  std::array<std::uint8_t, 4096> bytes_{};
};

void print_row(const char* name, const Percentiles& p) {
  const auto us = [](Duration d) { return to_seconds(d) * 1e6; };
  std::printf("| %s | %llu | %.0f | %.0f | %.0f | %.0f |\n", name, static_cast<unsigned long long>(p.count), us(p.p50),
              us(p.p99), us(p.p999), us(p.max));
}

/// What did not become a pose, by cause.
void print_missed(const nlohmann::json& health) {
  const nlohmann::json& counts = health.at("counts");
  std::uint64_t dropped = 0;
  for (const auto& ring : health.at("rings")) dropped += ring.at("dropped").get<std::uint64_t>();
  std::printf("%s scans to poses, %s with fewer points, %s let go; %llu items dropped by rings, %s events late, %s LiDAR packets lost\n",
              counts.at("scans").dump().c_str(), counts.at("scans_thinned").dump().c_str(),
              counts.at("scans_let_go").dump().c_str(), static_cast<unsigned long long>(dropped),
              counts.at("late_events").dump().c_str(), health.at("sources").at("lidar").at("lost").dump().c_str());
}

int run(Duration length) {
  const test::TemporaryFolder folder;
  BarePort bare{folder.file("bare")};
  Relay relay{folder.file("sim-imu"), folder.file("imu"), bare};
  auto app = App::open(config_in(folder), "bench");
  const test::LiveSimulator simulator = simulator_in(folder, length + kWarmUp);
  if (!app || !simulator.started() || !(*app)->start()) {
    std::fprintf(stderr, "bench_latency: cannot start (%s)\n", app ? "simulator or server" : app.reason());
    return 1;
  }
  client::Connection connection{folder.file("slamd.sock")};
  client::PosePage page = connection.pose_page();
  const auto frame_to_page = std::make_unique<Histogram>();
  const auto sleep = std::make_unique<Histogram>();
  const auto port = std::make_unique<Histogram>();
  {
    const int imu_priority = RealTimeConfig{}.imu_priority;
    const Worker sleeper{{"bench-sleep", imu_priority}, [&](const std::stop_token& stop) { measure_sleep(stop, *sleep); }};
    const Worker reader{{"bench-reader", imu_priority}, [&](const std::stop_token& stop) { bare.read(stop, *port); }};
    const Worker cable{{"bench-cable", imu_priority - 1},
                       [&](const std::stop_token& stop) { relay.run(stop, page, *frame_to_page); }};
    if (!cable.scheduled()) std::fprintf(stderr, "bench_latency: %s\n", cable.scheduled().reason());
    const HostTime end = host_now() + length + kWarmUp;
    while (host_now() < end && (*app)->supervise()) pause_for(100ms);
  }
  const Percentiles a = frame_to_page->percentiles(), b = sleep->percentiles(), c = port->percentiles();
  print_missed(connection.call("get_status").result.at("health"));
  std::printf("\n| microseconds | count | p50 | p99 | p99.9 | max |\n| --- | --- | --- | --- | --- | --- |\n");
  print_row("IMU frame in the port to its pose on the page", a);
  print_row("a thread that only sleeps 5 ms, too late by", b);
  print_row("a frame through a port whose reader does nothing else", c);
  print_row("difference to the sleeper", {a.count, a.p50 - b.p50, a.p90 - b.p90, a.p99 - b.p99, a.p999 - b.p999, a.max - b.max});
  print_row("difference to the bare port", {a.count, a.p50 - c.p50, a.p90 - c.p90, a.p99 - c.p99, a.p999 - c.p999, a.max - c.max});
  print_row("end of a scan to its pose, since the start", (*app)->scan_latency().percentiles());
  (*app)->stop();
  return 0;
}

}  // namespace
}  // namespace slamd

int main(int argc, char** argv) {
  return slamd::run(std::chrono::seconds{argc > 1 ? std::atoi(argv[1]) : 60});
}
