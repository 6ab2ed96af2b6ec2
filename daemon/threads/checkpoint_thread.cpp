#include "daemon/threads/checkpoint_thread.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"
#include "daemon/threads/state_directory.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{50};
constexpr std::size_t kMostSteps = 1'000;  // that wait for the disk
constexpr const char* kFileName = "/checkpoint.map";

}  // namespace

std::string CheckpointConfig::path() const {
  if (!folder.empty()) return folder + kFileName;
  const std::string given = state_directory();
  return given.empty() ? given : given + kFileName;
}

nlohmann::json to_json(const CheckpointReport& report) {
  return {{"state", report.state}, {"written", report.written}, {"steps", report.steps}, {"bytes", report.bytes}, {"reason", report.reason}};
}

CheckpointThread::CheckpointThread(const CheckpointConfig& config, const VehicleGeometry& vehicle)
    : config_{config}, path_{config.path()}, vehicle_{vehicle} {
  report_.state = path_.empty() ? "off" : "waiting";
}

bool CheckpointThread::is_due(HostTime now) const { return !offered_at_ || now - *offered_at_ >= config_.period; }

void CheckpointThread::offer(StoredMap map, HostTime now) {
  offered_at_ = now;
  if (map.motion) map.motion->host_to_utc = host_to_utc();
  const std::lock_guard lock{mutex_};
  waiting_.map = std::move(map);
  waiting_.steps.clear();
}

void CheckpointThread::offer(StoredStep step) {
  step.motion.host_to_utc = host_to_utc();
  const std::lock_guard lock{mutex_};
  if (waiting_.steps.size() < kMostSteps) return waiting_.steps.push_back(std::move(step));
  offered_at_.reset();  // a disk that is too slow for them gets the whole map next
}

void CheckpointThread::run(const std::stop_token& stop) {
  for (bool last = false; !last;) {
    last = stop.stop_requested();
    Offers offers;
    {
      const std::lock_guard lock{mutex_};
      offers = std::exchange(waiting_, {});
    }
    if (offers.map || !offers.steps.empty()) write(offers);
    if (!last) pause_for(kPollPeriod);
  }
}

void CheckpointThread::write(const Offers& offers) {
  const Result<std::size_t> bytes = put(offers);
  const std::lock_guard lock{mutex_};
  report_.state = bytes ? "healthy" : "failed";
  report_.reason = bytes ? "" : bytes.reason();
  if (!bytes) return;
  if (offers.map) {
    ++report_.written;
    report_.bytes = 0;
  }
  report_.steps += offers.steps.size();
  report_.bytes += *bytes;
}

/// Bytes written. After a failure nothing is added before a whole map has been written again.
Result<std::size_t> CheckpointThread::put(const Offers& offers) {
  std::size_t size = 0;
  if (offers.map) {
    const std::vector<std::uint8_t> bytes = encode(*offers.map, vehicle_);
    const Result<void> written = write_checkpoint(bytes, path_);
    failure_ = written ? nullptr : written.reason();
    if (!written) return Error{failure_};
    size = bytes.size();
  }
  if (offers.steps.empty()) return size;
  if (failure_ != nullptr) return Error{failure_};
  std::vector<std::uint8_t> steps;
  for (const StoredStep& step : offers.steps) {
    const std::vector<std::uint8_t> bytes = encode(step);
    steps.insert(steps.end(), bytes.begin(), bytes.end());
  }
  const Result<void> added = append_to_checkpoint(steps, path_);
  failure_ = added ? nullptr : added.reason();
  if (!added) return Error{failure_};
  return size + steps.size();
}

CheckpointReport CheckpointThread::report() const {
  const std::lock_guard lock{mutex_};
  return report_;
}

}  // namespace slamd
