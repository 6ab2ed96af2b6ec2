#include "tools/slamctl/top.hpp"

#include <algorithm>
#include <numeric>

#include "tools/slamctl/text.hpp"

namespace slamd::slamctl {
namespace {

using nlohmann::json;

double per_second(const json& before, const json& after, double seconds) {
  const double grown = after.get<double>() - before.get<double>();
  return seconds > 0.0 && grown > 0.0 ? grown / seconds : 0.0;
}

double sum_of(const json& counts) {
  return std::accumulate(counts.begin(), counts.end(), 0.0,
                         [](double sum, const json& count) { return sum + count.get<double>(); });
}

/// For each entry of `after` that `before` has too, what `figure` makes of the two.
template <class Figure>
json for_each_of_both(const json& before, const json& after, Figure figure) {
  json figures = json::object();
  for (const auto& [name, entry] : after.items()) {
    const auto earlier = before.find(name);
    figures[name] = earlier != before.end() ? figure(*earlier, entry) : 0.0;
  }
  return figures;
}

std::string pose_lines(const json& status, const json& figures) {
  const json& pose = status.at("pose");
  const json& health = status.at("health");
  std::string text = format("slamd %s  up %.0f s  %s", status.at("version").get<std::string>().c_str(),
                            number(health, "uptime_s"), pose.at("status").get<std::string>().c_str());
  if (!pose.at("reasons").empty()) text += " (" + joined(pose.at("reasons")) + ")";
  text += format("\npose %.1f /s  %.3f s old  sigma %.3f m  gates: scan %.2f", number(figures, "pose_rate_hz"),
                 number(pose, "age_s"), number(pose, "sigma_m"), number(pose, "lidar_test_ratio"));
  const json gnss = health.value("back_end", json::object()).value("gnss", json());
  if (gnss.is_object()) text += "  GPS " + gnss.value("trust", "unknown");
  return text + "\n";
}

std::string sensor_lines(const json& sources, const json& figures) {
  std::string text = format("%-10s %-24s %9s %8s %8s %11s\n", "SENSOR", "STATE", "RATE/s", "AGE s", "LOST/s", "REJECTED/s");
  for (const auto& [name, source] : sources.items()) {
    text += format("%-10s %-24s %9.1f %8.3f %8.1f %11.1f\n", name.c_str(), state_text(source).c_str(),
                   number(source, "rate_hz"), number(source, "age_s"), number(figures.at("lost_per_s"), name.c_str()),
                   number(figures.at("rejected_per_s"), name.c_str()));
  }
  return text;
}

std::string stage_lines(const json& stages) {
  std::string text = format("%-22s %9s %9s %9s %9s\n", "STAGE, ms", "P50", "P99", "P99.9", "MAX");
  for (const auto& [name, stage] : stages.items()) {
    text += format("%-22s %9.3f %9.3f %9.3f %9.3f\n", name.c_str(), number(stage, "p50"), number(stage, "p99"),
                   number(stage, "p999"), number(stage, "max"));
  }
  return text;
}

std::string ring_lines(const json& rings, const json& dropped_per_s) {
  std::string text = format("%-22s %9s %9s %9s %9s\n", "RING", "WAITING", "MOST", "OF", "DROPPED/s");
  for (const auto& [name, ring] : rings.items()) {
    text += format("%-22s %9.0f %9.0f %9.0f %9.1f\n", name.c_str(), number(ring, "size"), number(ring, "high_water"),
                   number(ring, "capacity"), number(dropped_per_s, name.c_str()));
  }
  return text;
}

/// The busiest first.
std::string thread_lines(const json& threads, const json& cpu_percent) {
  std::vector<std::string> names;
  for (const auto& [name, thread] : threads.items()) names.push_back(name);
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return number(cpu_percent, a.c_str()) > number(cpu_percent, b.c_str());
  });
  std::string text = format("%-22s %9s %9s %9s\n", "THREAD", "CPU %", "CPU s", "FIFO");
  for (const std::string& name : names) {
    text += format("%-22s %9.1f %9.1f %9.0f\n", name.c_str(), number(cpu_percent, name.c_str()),
                   number(threads.at(name), "cpu_s"), number(threads.at(name), "priority"));
  }
  return text;
}

}  // namespace

json top_figures(const json& before, const json& after) {
  const json& old_health = before.at("health");
  const json& health = after.at("health");
  const double seconds = (after.at("time_ns").get<double>() - before.at("time_ns").get<double>()) * 1e-9;
  const auto rate_of = [seconds](const char* key) {
    return [seconds, key](const json& a, const json& b) { return per_second(a.at(key), b.at(key), seconds); };
  };
  return {{"interval_s", seconds},
          {"pose_rate_hz", per_second(before.at("pose").at("sequence"), after.at("pose").at("sequence"), seconds)},
          {"cpu_percent", for_each_of_both(old_health.at("threads"), health.at("threads"),
                                           [&](const json& a, const json& b) { return 100.0 * rate_of("cpu_s")(a, b); })},
          {"lost_per_s", for_each_of_both(old_health.at("sources"), health.at("sources"), rate_of("lost"))},
          {"rejected_per_s", for_each_of_both(old_health.at("sources"), health.at("sources"),
                                              [seconds](const json& a, const json& b) {
                                                return per_second(sum_of(a.at("rejected")), sum_of(b.at("rejected")), seconds);
                                              })},
          {"dropped_per_s", for_each_of_both(old_health.at("rings"), health.at("rings"), rate_of("dropped"))}};
}

std::string top_text(const json& status, const json& figures) {
  const json& health = status.at("health");
  const json& memory = health.at("memory");
  const json& map = status.at("map");
  return pose_lines(status, figures) + "\n" + sensor_lines(health.at("sources"), figures) + "\n" +
         stage_lines(health.at("stages_ms")) + "\n" + ring_lines(health.at("rings"), figures.at("dropped_per_s")) + "\n" +
         thread_lines(health.at("threads"), figures.at("cpu_percent")) + "\n" +
         format("memory %.1f MB, most %.1f MB  map %.0f keyframes, %.1f MB  clients %.0f\n",
                number(memory, "resident_bytes") / 1e6, number(memory, "peak_bytes") / 1e6, number(map, "keyframes"),
                number(map, "bytes") / 1e6, number(status.at("server"), "clients"));
}

}  // namespace slamd::slamctl
