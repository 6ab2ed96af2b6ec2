// A server over a drive that is made up: for tests of clients in other languages. Serves the socket named on the command
// line, publishes a pose every 5 ms, prints "ready" after the first and ends when its standard input does.

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "daemon/server/host_clock.hpp"
#include "daemon/server/server.hpp"

namespace {

using namespace slamd;

constexpr int kPeriod_ms = 5;

void fill(MapStore& map, TrajectoryStore& trajectory) {
  for (int i = 0; i < 100; ++i) {
    Keyframe keyframe;
    keyframe.id = static_cast<std::uint64_t>(i);
    keyframe.state.T_odom_base.translation.x() = i;
    for (int k = 0; k < 50; ++k) keyframe.points.push_back({0.5F, static_cast<float>(k) + 0.5F, 0.5F, 9.0F});
    map.add(keyframe);
    trajectory.add(from_ns<HostTime>((i + 1) * 100'000'000LL), keyframe.state.T_odom_base);
  }
}

/// Three squares by two: an occupied one at its origin, the rest free but the last, which nobody has seen.
OccupancyGrid small_grid() {
  OccupancyGrid grid{.resolution_m = 0.5, .origin = {-1.0, 2.0}, .width = 3, .height = 2, .cells = std::vector<std::int8_t>(6, kFreeCell)};
  grid.cells.front() = kOccupiedCell;
  grid.cells.back() = kUnknownCell;
  return grid;
}

bool input_has_ended() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return ::poll(&input, 1, kPeriod_ms) > 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  MapStore map;
  TrajectoryStore trajectory;
  HealthBoard health{host_now()};
  health.add_source("lidar", [] { return SourceHealth{.last_arrival = host_now(), .received = 1, .state = "healthy"}; });
  Result<PosePublisher> publisher = PosePublisher::create();
  if (!publisher) return 1;
  PosePublisher pose = std::move(publisher).value();
  fill(map, trajectory);
  GridStore grid;
  grid.put(small_grid(), host_now());
  Server server{{.socket_path = argv[1], .save_dir = argv[2], .control_group = "", .limits = {}}, {.pose = pose, .map = map, .trajectory = trajectory, .health = health, .grid = &grid}, "0.0.1"};
  if (const Result<void> started = server.start(); !started) {
    std::fprintf(stderr, "%s\n", started.reason());
    return 1;
  }
  NavState state;
  state.status = TrackingStatus::kTracking;
  state.covariance = Matrix6d::Identity() * 0.01;
  int count = 0;
  do {
    state.time = host_now();
    state.T_odom_base.translation = {0.001 * count, 2.0, 3.0};
    pose.publish(state);
    if (count++ == 0) std::puts("ready");
    std::fflush(stdout);
  } while (!input_has_ended());
  return 0;
}
