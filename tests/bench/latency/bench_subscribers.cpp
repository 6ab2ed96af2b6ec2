// From a pose that is published to its line in the hands of each of 50 subscribers at 200 Hz, in the running server. Prints a
// table; bar: p99 below 300 us.
//     bench_subscribers [SECONDS]

#include <poll.h>

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

/// As the IMU's thread does: a pose every 5 ms, stamped when it is handed to the server.
void publish(const std::stop_token& stop, PosePublisher& publisher) {
  NavState state;
  state.status = TrackingStatus::kTracking;
  for (HostTime due = host_now(); !stop.stop_requested();) {
    due += kPeriod;
    const std::int64_t ns = to_ns(due);
    const timespec wanted{ns / 1'000'000'000, ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr);
    state.time = host_now();
    publisher.publish(state);
  }
}

/// All subscribers in one thread: reads whatever has come, stamps it first.
class Subscribers {
 public:
  explicit Subscribers(const std::string& path) {
    for (std::size_t i = 0; i < kSubscribers; ++i) {
      auto& subscriber = sockets_.emplace_back(path);
      if (!subscriber.send(kSubscribe)) continue;
      subscriber.receive(10s);
      polls_.push_back({subscriber.fd(), POLLIN, 0});
    }
  }
  std::size_t size() const { return polls_.size(); }

  void listen(const std::stop_token& stop, Histogram& latency) {
    while (!stop.stop_requested()) {
      if (::poll(polls_.data(), polls_.size(), 100) <= 0) continue;
      for (std::size_t i = 0; i < polls_.size(); ++i) {
        if ((polls_[i].revents & POLLIN) == 0) continue;
        while (sockets_[i].receive(0s) == client::LineSocket::Received::kLine) {
          latency.record(host_now() - sent(sockets_[i].line()));
        }
      }
    }
  }

 private:
  /// The pose's stamp, found without parsing the rest.
  static HostTime sent(std::string_view line) {
    constexpr std::string_view kKey = "\"time_ns\":";
    const std::size_t key = line.find(kKey);
    return from_ns<HostTime>(std::strtoll(line.data() + key + kKey.size(), nullptr, 10));
  }

  std::vector<client::LineSocket> sockets_;
  std::vector<pollfd> polls_;
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
