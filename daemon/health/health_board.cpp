#include "daemon/health/health_board.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "daemon/health/process_memory.hpp"
#include "daemon/health/thread_times.hpp"

namespace slamd {
namespace {

using nlohmann::json;

json clock_json(const ClockHealth& clock) {
  return {{"locked", clock.locked},
          {"skew_ppm", clock.skew_ppm},
          {"skew_sigma_ppm", clock.skew_sigma_ppm},
          {"sigma_us", clock.sigma_s * 1e6},
          {"jumps", clock.jumps}};
}

json source_json(const SourceHealth& health, double rate_hz, HostTime now) {
  json object = {{"device", health.device}, {"state", health.state},   {"received", health.received},
                 {"lost", health.lost},     {"rate_hz", rate_hz},      {"age_s", nullptr},
                 {"reason", health.reason}, {"state_s", to_seconds(now - health.state_since)},
                 {"times_faulty", health.times_faulty}, {"rejected", json::object()}};
  if (health.received > 0) object["age_s"] = to_seconds(now - health.last_arrival);
  for (const auto& [cause, count] : health.rejected) object["rejected"][cause] = count;
  for (const auto& [event, count] : health.events) object["events"][event] = count;
  if (health.clock) object["clock"] = clock_json(*health.clock);
  return object;
}

json ring_json(const RingCounts& counts) {
  return {{"capacity", counts.capacity}, {"size", counts.size},       {"high_water", counts.high_water},
          {"pushed", counts.pushed},     {"dropped", counts.dropped}};
}

/// 10 us to 10 s, three steps a decade; the same for all stages, so that tools may add them up.
constexpr std::array kLimits_us{10, 20, 50, 100, 200, 500, 1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 100'000,
                                200'000, 500'000, 1'000'000, 2'000'000, 5'000'000, 10'000'000};

json stage_json(const Histogram& histogram) {
  const auto ms = [](Duration duration) { return to_seconds(duration) * 1e3; };
  const Percentiles percentiles = histogram.percentiles();
  std::array<Duration, kLimits_us.size()> limits;
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = std::chrono::microseconds{kLimits_us[i]};
  const std::vector<std::uint64_t> counts = histogram.counts_up_to(limits);
  json buckets = json::array();
  for (std::size_t i = 0; i < limits.size(); ++i) buckets.push_back({ms(limits[i]), counts[i]});
  return {{"sum", ms(histogram.sum())},    {"buckets", std::move(buckets)},
          {"count", percentiles.count}, {"p50", ms(percentiles.p50)},   {"p90", ms(percentiles.p90)},
          {"p99", ms(percentiles.p99)}, {"p999", ms(percentiles.p999)}, {"max", ms(percentiles.max)}};
}

}  // namespace

void HealthBoard::add_source(std::string name, SourceProbe probe) {
  sources_.push_back({.name = std::move(name), .probe = std::move(probe)});
}

void HealthBoard::add_ring(std::string name, RingProbe probe) {
  rings_.emplace_back(std::move(name), std::move(probe));
}

void HealthBoard::add_stage(std::string name, const Histogram& histogram) {
  stages_.emplace_back(std::move(name), &histogram);
}

void HealthBoard::add_count(std::string name, CountProbe probe) {
  counts_.emplace_back(std::move(name), std::move(probe));
}

void HealthBoard::add_object(std::string name, ObjectProbe probe) {
  objects_.emplace_back(std::move(name), std::move(probe));
}

void HealthBoard::sample(HostTime now) {
  const double elapsed_s = to_seconds(now - (sampled_ == HostTime{} ? start_ : sampled_));
  if (elapsed_s <= 0.0) return;
  sampled_ = now;
  for (Source& source : sources_) {
    const std::uint64_t received = source.probe().received;
    source.rate_hz = static_cast<double>(received - source.previous) / elapsed_s;
    source.previous = received;
  }
}

json HealthBoard::to_json(HostTime now) const {
  const ProcessMemory memory = process_memory();
  json object = {{"uptime_s", to_seconds(now - start_)},
                 {"memory", {{"resident_bytes", memory.resident_bytes}, {"peak_bytes", memory.peak_bytes}}},
                 {"threads", json::object()},
                 {"sources", json::object()},
                 {"rings", json::object()},
                 {"stages_ms", json::object()},
                 {"counts", json::object()}};
  for (const auto& [name, time] : thread_times()) {
    object["threads"][name] = {{"cpu_s", time.cpu_s}, {"priority", time.priority}};
  }
  for (const Source& source : sources_) {
    object["sources"][source.name] = source_json(source.probe(), source.rate_hz, now);
  }
  for (const auto& [name, probe] : rings_) object["rings"][name] = ring_json(probe());
  for (const auto& [name, histogram] : stages_) object["stages_ms"][name] = stage_json(*histogram);
  for (const auto& [name, probe] : counts_) object["counts"][name] = probe();
  for (const auto& [name, probe] : objects_) object[name] = probe();
  return object;
}

}  // namespace slamd
