#pragma once
// The daemon's local socket: JSON-RPC 2.0, one object a line, on one thread of its own. It reads the pose page, the
// stores and the health board; it changes nothing in the daemon, and nothing that a client does reaches another thread.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "daemon/health/health_board.hpp"
#include "daemon/inject/fault_switch.hpp"
#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/pose_publisher.hpp"
#include "daemon/store/grid_store.hpp"
#include "daemon/store/map_store.hpp"
#include "daemon/store/trajectory_store.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// What one client, and all together, may take. Reaching a limit is counted and shown in get_status.
struct ServerLimits {
  std::size_t max_clients = 256;
  std::size_t max_request_bytes = 64 * 1024;      // a longer line is refused and its sender dropped
  double max_requests_per_s = 200.0;              // beyond it the client's requests wait in its own socket
  std::size_t max_outbound_bytes = 512 * 1024;    // waiting for one client; beyond it notifications are lost
  double stall_timeout_s = 10.0;                  // a client that takes nothing for so long is dropped
  std::size_t max_jobs = 8;                       // maps and files being made or waiting for it
};

struct ServerConfig {
  std::string socket_path = "/run/slamd/slamd.sock";
  std::string save_dir = "/var/lib/slamd/maps";   // save_map writes here and nowhere else
  std::string control_group{};  // its members may call methods that write; empty: whoever may connect
  ServerLimits limits;
};

/// What a client says of the wheels: drivers/wheel's reading.
struct PushedOdometry {
  std::uint32_t device_us = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// Recordings that clients begin and end. Any thread; empty functions: there is no recorder.
struct RecordingControl {
  /// 0 of a limit: the configured one. Gives the file's path.
  std::function<Result<std::string>(const std::string& name, double max_s, double max_bytes)> start{};
  /// What was recorded, as the answer has it.
  std::function<Result<nlohmann::json>()> stop{};
};

/// What the server reads. All must outlive it.
struct ServerSources {
  const PosePublisher& pose;
  const MapStore& map;
  const TrajectoryStore& trajectory;
  HealthBoard& health;
  FaultBoard* faults = nullptr;  // null: nothing may be injected
  /// Writes the newest raw input as a drive folder of that name (empty: one of its own) and gives its path. Any thread.
  std::function<Result<std::string>(const std::string& name)> dump{};
  /// Takes a reading of the wheels, on the server's thread, quickly; false when it cannot.
  std::function<bool(const PushedOdometry& pushed)> push_odometry{};
  const GridStore* grid = nullptr;  // null: not in planar mode
  RecordingControl recording{};
};

class Server {
 public:
  Server(ServerConfig config, ServerSources sources, std::string version);
  ~Server();  // stops

  /// Looks up control_group, binds the socket (mode 0660; a stale one is replaced; a second instance is refused), or takes
  /// the one that is handed over, and starts the threads: one for all sockets, one for long jobs. On failure nothing is left behind.
  Result<void> start(UniqueFd listening = {});

  /// Any thread, while it runs. The folder and the limits but max_jobs hold from now on, those of requests for new clients.
  void reconfigure(const ServerConfig& config);

  /// Ends both threads, closes all clients, removes the socket. Idempotent.
  void stop();

  /// Any thread. Grows at least four times a second while the server's thread is alive: food for a watchdog.
  std::uint64_t heartbeats() const;

  /// Any thread. Clients connected now.
  std::size_t clients() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace slamd
