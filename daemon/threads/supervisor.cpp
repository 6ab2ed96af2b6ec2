#include "daemon/threads/supervisor.hpp"

#include "estimator/types/nav_state.hpp"

namespace slamd {
namespace {

std::string reason_names(std::uint32_t reasons) {
  if (reasons == 0) return "none";
  std::string names;
  for (; reasons != 0; reasons &= reasons - 1) {
    if (!names.empty()) names += ',';
    names += name(static_cast<StatusReason>(reasons & (~reasons + 1)));
  }
  return names;
}

}  // namespace

Condition condition(const SourceHealth& health) {
  std::string details = " received=" + std::to_string(health.received) + " lost=" + std::to_string(health.lost);
  for (const auto& [cause, count] : health.rejected) details += " rejected_" + cause + "=" + std::to_string(count);
  if (!health.device.empty()) details += " device=" + health.device;
  if (health.state == "healthy") return {LogLevel::kInfo, "state=healthy", details};
  const std::string reason = health.reason.empty() ? "" : " reason=" + health.reason;
  const bool starts = health.state == "starting";
  return {starts ? LogLevel::kInfo : LogLevel::kWarning, "state=" + health.state + reason + ", continuing:", details};
}

Condition condition(const std::optional<PoseSample>& sample) {
  const PoseSample newest = sample.value_or(PoseSample{});
  const auto status = static_cast<TrackingStatus>(newest.status);
  const bool usable = status != TrackingStatus::kDegraded && status != TrackingStatus::kLost;
  return {usable ? LogLevel::kInfo : LogLevel::kWarning,
          std::string{"status="} + name(status) + " reasons=" + reason_names(newest.reasons), ""};
}

Condition condition(const RingCounts& counts, std::uint64_t dropped_before) {
  if (counts.dropped == dropped_before) return {LogLevel::kInfo, "state=flowing", ""};
  return {LogLevel::kWarning, "state=dropping, continuing:", " dropped=" + std::to_string(counts.dropped)};
}

const SensorWatch& Supervisor::watch_sensor(const SensorPatience& patience, SensorWatch::Probe probe) {
  return *sensors_.emplace_back(std::make_unique<SensorWatch>(patience, std::move(probe)));
}

void Supervisor::watch_source(std::string source, HealthBoard::SourceProbe probe) {
  sources_.emplace_back(std::move(source), std::move(probe));
}

void Supervisor::watch_ring(std::string ring, HealthBoard::RingProbe probe) {
  rings_.push_back({std::move(ring), std::move(probe), 0});
}

void Supervisor::look(HostTime now) {
  for (const auto& sensor : sensors_) sensor->look(now);
  for (const auto& [source, probe] : sources_) changes_.look(source, condition(probe()), now);
  for (Ring& ring : rings_) {
    const RingCounts counts = ring.probe();
    if (counts.dropped == 0) continue;
    changes_.look("ring_" + ring.name, condition(counts, std::exchange(ring.dropped, counts.dropped)), now);
  }
  for (const Budget& budget : budgets_) {
    if (const std::uint64_t count = budget.let_go(); count > 0) {
      changes_.look("budget_" + budget.name, {LogLevel::kWarning, "state=reached, continuing " + budget.consequence + ":", " keyframes=" + std::to_string(count)}, now);
    }
  }
  if (pose_) changes_.look("pose", condition(pose_()), now);
}

std::string Supervisor::summary() const {
  const PoseSample newest = pose_ ? pose_().value_or(PoseSample{}) : PoseSample{};
  std::string text = name(static_cast<TrackingStatus>(newest.status));
  if (newest.reasons != 0) text += " (" + reason_names(newest.reasons) + ")";
  const char* separator = "; ";
  for (const auto& [source, probe] : sources_) {
    text += separator + source + " " + probe().state;
    separator = ", ";
  }
  return text;
}

}  // namespace slamd
