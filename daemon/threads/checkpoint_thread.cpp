#include "daemon/threads/checkpoint_thread.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/threads/pause.hpp"
#include "daemon/threads/state_directory.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{50};
constexpr const char* kFileName = "/checkpoint.map";

}  // namespace

std::string CheckpointConfig::path() const {
  if (!folder.empty()) return folder + kFileName;
  const std::string given = state_directory();
  return given.empty() ? given : given + kFileName;
}

nlohmann::json to_json(const CheckpointReport& report) {
  return {{"state", report.state}, {"written", report.written}, {"bytes", report.bytes}, {"reason", report.reason}};
}

CheckpointThread::CheckpointThread(const CheckpointConfig& config, const VehicleGeometry& vehicle)
    : config_{config}, path_{config.path()}, vehicle_{vehicle} {
  report_.state = path_.empty() ? "off" : "waiting";
}

bool CheckpointThread::is_due(HostTime now) const { return !path_.empty() && now - offered_at_ >= config_.period; }

void CheckpointThread::offer(StoredMap map, HostTime now) {
  offered_at_ = now;
  const std::lock_guard lock{mutex_};
  waiting_ = std::move(map);
}

void CheckpointThread::run(const std::stop_token& stop) {
  for (bool last = false; !last;) {
    last = stop.stop_requested();
    std::optional<StoredMap> map;
    {
      const std::lock_guard lock{mutex_};
      map = std::exchange(waiting_, std::nullopt);
    }
    if (map) write(*map);
    if (!last) pause_for(kPollPeriod);
  }
}

void CheckpointThread::write(const StoredMap& map) {
  const std::vector<std::uint8_t> bytes = encode(map, vehicle_);
  const Result<void> written = write_checkpoint(bytes, path_);
  const std::lock_guard lock{mutex_};
  report_.state = written ? "healthy" : "failed";
  report_.reason = written ? "" : written.reason();
  if (!written) return;
  ++report_.written;
  report_.bytes = bytes.size();
}

CheckpointReport CheckpointThread::report() const {
  const std::lock_guard lock{mutex_};
  return report_;
}

}  // namespace slamd
