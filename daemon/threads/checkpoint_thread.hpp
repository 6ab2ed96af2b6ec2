#pragma once
// The thread that keeps the newest map on disk: takes it from the mapping thread and writes it every few seconds. Not real-time;
// a disk that is slow or full stops nothing but this.

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>

#include "daemon/store/checkpoint_file.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct CheckpointConfig {
  std::string folder;                          // empty: that of the service manager; none there either: no checkpoints
  Duration period = std::chrono::seconds{10};
  std::size_t byte_budget = 8U * 1024 * 1024;  // of the newest keyframes' points; older ones are not kept over a restart

  /// Of the one file; empty: no checkpoints.
  std::string path() const;
};

/// How the newest checkpoint stands.
struct CheckpointReport {
  std::string state;         // "off", "waiting" for a first one, "healthy", "failed"
  std::uint64_t written = 0;
  std::size_t bytes = 0;     // of the newest one
  std::string reason;        // why it failed
};

nlohmann::json to_json(const CheckpointReport& report);

class CheckpointThread {
 public:
  CheckpointThread(const CheckpointConfig& config, const VehicleGeometry& vehicle);

  /// The mapping thread: whether the next checkpoint is to be made; then it hands one in.
  bool is_due(HostTime now) const;
  void offer(StoredMap map, HostTime now);

  /// The thread's body: returns within the time that a write takes after a stop request, with all written that was offered.
  void run(const std::stop_token& stop);

  /// Any thread.
  CheckpointReport report() const;
  std::size_t byte_budget() const { return config_.byte_budget; }

 private:
  void write(const StoredMap& map);

  const CheckpointConfig config_;
  const std::string path_;
  const VehicleGeometry vehicle_;
  HostTime offered_at_;              // of the mapping thread
  mutable std::mutex mutex_;
  std::optional<StoredMap> waiting_;
  CheckpointReport report_;
};

}  // namespace slamd
