#pragma once
// The thread that keeps the newest map on disk: takes it from the mapping thread, whole now and then and each keyframe in between,
// and writes it. Not real-time; a disk that is slow or full stops nothing but this.

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "daemon/store/checkpoint_file.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct CheckpointConfig {
  std::string folder;                          // empty: that of the service manager; none there either: no checkpoints
  Duration period = std::chrono::seconds{30};  // of the whole map; keyframes are added as they come
  std::size_t byte_budget = 8U * 1024 * 1024;  // of the newest keyframes' points; older ones are not kept over a restart

  /// Of the one file; empty: no checkpoints.
  std::string path() const;
};

/// How the newest checkpoint stands.
struct CheckpointReport {
  std::string state;         // "off", "waiting" for a first one, "healthy", "failed"
  std::uint64_t written = 0; // whole ones
  std::uint64_t steps = 0;   // keyframes added to them
  std::size_t bytes = 0;     // of the newest one, with what was added
  std::string reason;        // why it failed
};

nlohmann::json to_json(const CheckpointReport& report);

class CheckpointThread {
 public:
  CheckpointThread(const CheckpointConfig& config, const VehicleGeometry& vehicle);

  bool is_on() const { return !path_.empty(); }
  /// The mapping thread: whether the whole map is to be kept next; then it hands one in.
  bool is_due(HostTime now) const;
  void offer(StoredMap map, HostTime now);
  /// The mapping thread: what the map has gained since the last offer.
  void offer(StoredStep step);

  /// The thread's body: returns within the time that a write takes after a stop request, with all written that was offered.
  void run(const std::stop_token& stop);

  /// Any thread.
  CheckpointReport report() const;
  std::size_t byte_budget() const { return config_.byte_budget; }

 private:
  /// What the mapping thread has offered: first the map, then what it has gained since.
  struct Offers {
    std::optional<StoredMap> map;
    std::vector<StoredStep> steps;
  };
  void write(const Offers& offers);
  Result<std::size_t> put(const Offers& offers);

  const CheckpointConfig config_;
  const std::string path_;
  const VehicleGeometry vehicle_;
  std::optional<HostTime> offered_at_;  // of the mapping thread; the whole map
  const char* failure_ = "there is no whole map to add to";  // of run(); null: the file is of this process, and whole
  mutable std::mutex mutex_;
  Offers waiting_;
  CheckpointReport report_;
};

}  // namespace slamd
