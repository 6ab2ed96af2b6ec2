#include "tools/slamctl/metrics.hpp"

#include <utility>
#include <vector>

namespace slamd::slamctl {
namespace {

using nlohmann::json;
using Labels = std::vector<std::pair<const char*, std::string>>;

std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    text += c == '\n' ? std::string{"\\n"} : std::string{c};
  }
  return text;
}

std::string in_braces(const Labels& labels) {
  std::string text;
  for (const auto& [name, value] : labels) text += (text.empty() ? "" : ",") + std::string{name} + "=\"" + escaped(value) + '"';
  return text.empty() ? "" : "{" + text + "}";
}

/// All samples of one name, below its HELP and TYPE; without samples it is left out.
class Family {
 public:
  Family(std::string name, const char* type, const char* help)
      : name_{std::move(name)}, head_{"# HELP " + name_ + ' ' + help + "\n# TYPE " + name_ + ' ' + type + '\n'} {}

  void add(const json& value, const Labels& labels = {}, const char* suffix = "") {
    if (value.is_number()) samples_ += name_ + suffix + in_braces(labels) + ' ' + value.dump() + '\n';
  }

  std::string text() const { return samples_.empty() ? "" : head_ + samples_; }

 private:
  std::string name_;
  std::string head_;
  std::string samples_;
};

std::string single(const char* name, const char* type, const char* help, const json& value) {
  Family family{name, type, help};
  family.add(value);
  return family.text();
}

std::string pose_metrics(const json& pose) {
  Family status{"slamd_status", "gauge", "1 for the status of the pose, 0 for the others."};
  for (const char* each : {"INITIALISING", "TRACKING", "DEGRADED", "LOST"}) {
    status.add(pose.at("status") == each ? 1 : 0, {{"status", each}});
  }
  return status.text() + single("slamd_pose_age_seconds", "gauge", "Age of the newest pose.", pose.at("age_s"));
}

std::string source_metrics(const json& sources) {
  Family state{"slamd_source_state", "gauge", "1 for the sensor's state, 0 for the others."};
  Family faulty{"slamd_source_faulty_total", "counter", "Times that the sensor became faulty."};
  Family rate{"slamd_source_rate_hertz", "gauge", "Good items a second."};
  Family age{"slamd_source_age_seconds", "gauge", "Age of the newest good item."};
  Family received{"slamd_source_received_total", "counter", "Good items."};
  Family lost{"slamd_source_lost_total", "counter", "Items that never arrived."};
  Family rejected{"slamd_source_rejected_total", "counter", "Items refused, by cause."};
  for (const auto& [name, source] : sources.items()) {
    const Labels labels{{"source", name}};
    for (const char* each : {"absent", "starting", "healthy", "degraded", "faulty"}) {
      state.add(source.at("state") == each ? 1 : 0, {{"source", name}, {"state", each}});
    }
    faulty.add(source.at("times_faulty"), labels);
    rate.add(source.at("rate_hz"), labels);
    age.add(source.at("age_s"), labels);
    received.add(source.at("received"), labels);
    lost.add(source.at("lost"), labels);
    for (const auto& [cause, count] : source.at("rejected").items()) {
      rejected.add(count, {{"source", name}, {"cause", cause}});
    }
  }
  return state.text() + faulty.text() + rate.text() + age.text() + received.text() + lost.text() + rejected.text();
}

std::string ring_metrics(const json& rings) {
  Family dropped{"slamd_ring_dropped_total", "counter", "Items dropped between threads."};
  Family most{"slamd_ring_high_water", "gauge", "Most items that ever waited in the ring."};
  for (const auto& [name, ring] : rings.items()) {
    dropped.add(ring.at("dropped"), {{"ring", name}});
    most.add(ring.at("high_water"), {{"ring", name}});
  }
  return dropped.text() + most.text();
}

std::string stage_metrics(const json& stages) {
  Family seconds{"slamd_stage_seconds", "histogram", "Duration of a stage since the start."};
  Family longest{"slamd_stage_longest_seconds", "gauge", "The longest since the start."};
  for (const auto& [name, stage] : stages.items()) {
    for (const json& bucket : stage.at("buckets")) {
      seconds.add(bucket.at(1), {{"stage", name}, {"le", json(bucket.at(0).get<double>() * 1e-3).dump()}}, "_bucket");
    }
    seconds.add(stage.at("count"), {{"stage", name}, {"le", "+Inf"}}, "_bucket");
    seconds.add(stage.at("sum").get<double>() * 1e-3, {{"stage", name}}, "_sum");
    seconds.add(stage.at("count"), {{"stage", name}}, "_count");
    longest.add(stage.at("max").get<double>() * 1e-3, {{"stage", name}});
  }
  return seconds.text() + longest.text();
}

std::string thread_metrics(const json& threads) {
  Family seconds{"slamd_thread_cpu_seconds_total", "counter", "Processor time, by thread."};
  for (const auto& [name, thread] : threads.items()) seconds.add(thread.at("cpu_s"), {{"thread", name}});
  return seconds.text();
}

std::string count_metrics(const json& counts) {
  Family events{"slamd_events_total", "counter", "Other totals of the daemon, by name."};
  for (const auto& [name, count] : counts.items()) events.add(count, {{"event", name}});
  return events.text();
}

}  // namespace

std::string metrics_text(const json& status) {
  const json& health = status.at("health");
  const json& map = status.at("map");
  return pose_metrics(status.at("pose")) +
         single("slamd_uptime_seconds", "gauge", "Since the daemon's start.", health.at("uptime_s")) +
         single("slamd_resident_memory_bytes", "gauge", "Memory in use.", health.at("memory").at("resident_bytes")) +
         source_metrics(health.at("sources")) + ring_metrics(health.at("rings")) +
         stage_metrics(health.at("stages_ms")) + thread_metrics(health.at("threads")) + count_metrics(health.at("counts")) +
         single("slamd_map_keyframes", "gauge", "Keyframes of the map.", map.at("keyframes")) +
         single("slamd_map_points", "gauge", "Points of the map.", map.at("points")) +
         single("slamd_map_bytes", "gauge", "Memory of the map.", map.at("bytes")) +
         single("slamd_clients", "gauge", "Clients connected.", status.at("server").at("clients"));
}

}  // namespace slamd::slamctl
