// From a pose that is published to its line in the hands of each of 50 subscribers at 200 Hz, in the running server. Prints a
// table; bar: p99 below 300 us.
//     bench_subscribers [SECONDS]

#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/server/host_clock.hpp"
#include "daemon/server/server.hpp"
#include "daemon/threads/worker.hpp"
#include "tools/client/line_socket.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSubscribers = 50;
constexpr Duration kPeriod = 5ms;
constexpr std::string_view kSubscribe = R"({"jsonrpc":"2.0","id":1,"method":"subscribe","params":{"topic":"pose","rate_hz":1000}})"
                                        "\n";

/// A pose whose numbers are as long as real ones.
NavState some_pose() {
  NavState state;
  state.status = TrackingStatus::kTracking;
  state.T_odom_base = {Eigen::Quaterniond{0.3, -0.1, 0.2, 0.9}.normalized(), {123.0 / 7.0, -45.0 / 7.0, 1.0 / 7.0}};
  state.velocity_mps = {22.0 / 7.0, 1.0 / 30.0, -1.0 / 300.0};
  state.angular_velocity_rads = {1.0 / 70.0, -1.0 / 90.0, 1.0 / 3.0};
  state.covariance = Matrix6d::NullaryExpr([](Eigen::Index row, Eigen::Index column) {
    return 1e-4 / static_cast<double>(7 + row * column);
  });
  return state;
}

/// As the IMU's thread does: a pose every 5 ms, stamped when it is handed to the server.
void publish(const std::stop_token& stop, PosePublisher& publisher) {
  NavState state = some_pose();
  for (HostTime due = host_now(); !stop.stop_requested();) {
    due += kPeriod;
    const std::int64_t ns = to_ns(due);
    const timespec wanted{ns / 1'000'000'000, ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr);
    state.time = host_now();
    publisher.publish(state);
  }
}

/// All subscribers in one thread, which costs each as little as it can: a line is taken whole with one call and stamped at once.
class Subscribers {
 public:
  explicit Subscribers(const std::string& path) {
    for (std::size_t i = 0; i < kSubscribers; ++i) {
      auto& subscriber = sockets_.emplace_back(path);
      if (!subscriber.send(kSubscribe)) continue;
      subscriber.receive(10s);
      epoll_event wanted{.events = EPOLLIN, .data = {.fd = subscriber.fd()}};
      if (::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, subscriber.fd(), &wanted) == 0) ++size_;
    }
  }
  std::size_t size() const { return size_; }

  void listen(const std::stop_token& stop, Histogram& latency) {
    std::array<epoll_event, kSubscribers> ready;
    std::array<char, 65536> bytes;
    while (!stop.stop_requested()) {
      const int count = ::epoll_wait(epoll_.get(), ready.data(), ready.size(), 100);
      for (int i = 0; i < count; ++i) {
        const ssize_t size = ::recv(ready[i].data.fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
        const HostTime now = host_now();
        if (size > 0) record({bytes.data(), static_cast<std::size_t>(size)}, now, latency);
      }
    }
  }

 private:
  /// The stamps of the poses, found without parsing the rest; a reader that is behind gets several at once.
  static void record(std::string_view lines, HostTime now, Histogram& latency) {
    constexpr std::string_view kKey = "\"time_ns\":";
    for (std::size_t key = lines.find(kKey); key != std::string_view::npos; key = lines.find(kKey, key + 1)) {
      latency.record(now - from_ns<HostTime>(std::strtoll(lines.data() + key + kKey.size(), nullptr, 10)));
    }
  }

  std::vector<client::LineSocket> sockets_;
  UniqueFd epoll_{::epoll_create1(EPOLL_CLOEXEC)};
  std::size_t size_ = 0;
};

int run(Duration length) {
  const std::string path = std::filesystem::temp_directory_path() / ("bench_subscribers_" + std::to_string(::getpid()));
  MapStore map;
  TrajectoryStore trajectory;
  HealthBoard health{host_now()};
  Result<PosePublisher> made = PosePublisher::create();
  if (!made) return 1;
  PosePublisher publisher = std::move(made).value();
  ServerConfig config;
  config.socket_path = path;
  Server server{config, {publisher, map, trajectory, health}, "bench"};
  if (const Result<void> started = server.start(); !started) return std::fprintf(stderr, "%s\n", started.reason()), 1;
  Subscribers subscribers{path};
  const auto latency = std::make_unique<Histogram>();
  {
    const Worker writer{{"bench-imu", RealTimeConfig{}.imu_priority},
                        [&](const std::stop_token& stop) { publish(stop, publisher); }};
    const Worker reader{{"bench-readers"}, [&](const std::stop_token& stop) { subscribers.listen(stop, *latency); }};
    timespec wait{length.count() / 1'000'000'000, length.count() % 1'000'000'000};
    ::nanosleep(&wait, nullptr);
  }
  server.stop();
  const Percentiles p = latency->percentiles();
  const auto us = [](Duration d) { return to_seconds(d) * 1e6; };
  std::printf("| microseconds | count | p50 | p99 | p99.9 | max |\n| --- | --- | --- | --- | --- | --- |\n| pose published to %zu "
              "subscribers at 200 Hz | %llu | %.0f | %.0f | %.0f | %.0f |\n", subscribers.size(),
              static_cast<unsigned long long>(p.count), us(p.p50), us(p.p99), us(p.p999), us(p.max));
  return 0;
}

}  // namespace
}  // namespace slamd

int main(int argc, char** argv) {
  return slamd::run(std::chrono::seconds{argc > 1 ? std::atoi(argv[1]) : 10});
}
