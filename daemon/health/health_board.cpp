#include "daemon/health/health_board.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "daemon/health/process_memory.hpp"

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

json stage_json(const Percentiles& percentiles) {
  const auto ms = [](Duration duration) { return to_seconds(duration) * 1e3; };
  return {{"count", percentiles.count}, {"p50", ms(percentiles.p50)},   {"p90", ms(percentiles.p90)},
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
                 {"sources", json::object()},
                 {"rings", json::object()},
                 {"stages_ms", json::object()},
                 {"counts", json::object()}};
  for (const Source& source : sources_) {
    object["sources"][source.name] = source_json(source.probe(), source.rate_hz, now);
  }
  for (const auto& [name, probe] : rings_) object["rings"][name] = ring_json(probe());
  for (const auto& [name, histogram] : stages_) object["stages_ms"][name] = stage_json(histogram->percentiles());
  for (const auto& [name, probe] : counts_) object["counts"][name] = probe();
  for (const auto& [name, probe] : objects_) object[name] = probe();
  return object;
}

std::string HealthBoard::line() const {
  std::string text;
  for (const Source& source : sources_) {
    char rate[64];
    std::snprintf(rate, sizeof rate, " %.1f/s ", source.rate_hz);
    text += source.name + rate;
  }
  std::uint64_t dropped = 0;
  for (const auto& ring : rings_) dropped += ring.second().dropped;
  return text + "dropped " + std::to_string(dropped);
}

}  // namespace slamd
