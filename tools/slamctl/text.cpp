#include "tools/slamctl/text.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace slamd::slamctl {
namespace {

using nlohmann::json;

constexpr double kDegrees = 180.0 / M_PI;

/// Indented below its sensor; nothing for sensors without a clock.
std::string clock_line(const json& source) {
  const auto clock = source.find("clock");
  if (clock == source.end()) return "";
  return format("           clock skew %.2f +- %.2f ppm, sigma %.1f us%s\n", number(*clock, "skew_ppm"),
                number(*clock, "skew_sigma_ppm"), number(*clock, "sigma_us"),
                clock->value("locked", false) ? "" : ", not locked yet");
}

std::string source_line(const std::string& name, const json& source) {
  double rejected = 0.0;
  for (const json& count : source.at("rejected")) rejected += count.get<double>();
  return format("  %-8s %-9s %8.1f /s  age %6.3f s  lost %.0f  rejected %.0f  %s\n", name.c_str(), state_text(source).c_str(),
                number(source, "rate_hz"), number(source, "age_s"), number(source, "lost"), rejected,
                source.at("device").get<std::string>().c_str()) +
         clock_line(source);
}

std::string stage_line(const std::string& name, const json& stage) {
  return format("  %-16s p50 %8.3f  p99 %8.3f  max %8.3f ms  of %.0f\n", name.c_str(), number(stage, "p50"),
                number(stage, "p99"), number(stage, "max"), number(stage, "count"));
}

std::string ring_line(const std::string& name, const json& ring) {
  return format("  %-16s most %.0f of %.0f  dropped %.0f\n", name.c_str(), number(ring, "high_water"),
                number(ring, "capacity"), number(ring, "dropped"));
}

template <class Line>
std::string section(const char* title, const json& entries, Line line) {
  if (entries.empty()) return "";
  std::string text = std::string{title} + "\n";
  for (const auto& [name, entry] : entries.items()) text += line(name, entry);
  return text;
}

/// Lines about what the back end had no more room for; none as long as all has.
std::string back_end_budgets(const json& back_end) {
  std::string text;
  if (number(back_end, "forgotten_clouds") > 0.0) {
    text += format("loops: BUDGET reached, none is closed with the oldest %.0f keyframes\n", number(back_end, "forgotten_clouds"));
  }
  if (back_end.value("budget_reached", false)) {
    text += format("graph: BUDGET of %.0f MB reached, odometry alone carries on (%.0f keyframes left out)\n",
                   number(back_end, "byte_budget") / 1e6, number(back_end, "left_out_keyframes"));
  }
  return text;
}

}  // namespace

std::string format(const char* pattern, ...) {
  char text[512];
  va_list values;
  va_start(values, pattern);
  std::vsnprintf(text, sizeof text, pattern, values);
  va_end(values);
  return text;
}

std::string joined(const json& names) {
  std::string text;
  for (const json& name : names) text += (text.empty() ? "" : " ") + name.get<std::string>();
  return text;
}

double number(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

std::string state_text(const json& source) {
  const std::string state = source.at("state");
  return state == "healthy" ? state : state + " (" + source.at("reason").get<std::string>() + ")";
}

std::string status_text(const json& status) {
  const json& health = status.at("health");
  const json& pose = status.at("pose");
  std::string text = pose.at("status").get<std::string>();
  if (!pose.at("reasons").empty()) text += " (" + joined(pose.at("reasons")) + ")";
  text += format("  pose %.0f, %.3f s old\n", number(pose, "sequence"), number(pose, "age_s"));
  text += format("up %.0f s  memory %.1f MB  slamd %s\n", number(health, "uptime_s"),
                 number(health.at("memory"), "resident_bytes") / 1e6, status.at("version").get<std::string>().c_str());
  text += section("sources", health.at("sources"), source_line);
  text += section("stages", health.at("stages_ms"), stage_line);
  text += section("rings", health.at("rings"), ring_line);
  text += section("counts", health.at("counts"), [](const std::string& name, const json& count) {
    return format("  %-16s %.0f\n", name.c_str(), count.get<double>());
  });
  const json& map = status.at("map");
  text += format("map: %.0f keyframes, %.0f points, %.1f MB  path: %.0f poses  clients: %.0f\n",
                 number(map, "keyframes"), number(map, "points"), number(map, "bytes") / 1e6,
                 number(status.at("trajectory"), "poses"), number(status.at("server"), "clients"));
  if (map.value("budget_reached", false)) {
    text += format("map: BUDGET of %.0f MB reached, the oldest %.0f keyframes are forgotten\n",
                   number(map, "byte_budget") / 1e6, number(map, "evicted_keyframes"));
  }
  text += back_end_budgets(health.value("back_end", json::object()));
  return text;
}

std::string pose_text(const json& pose) {
  const auto p = pose.at("T_map_base").at("translation_m").get<std::array<double, 3>>();
  const auto q = pose.at("T_map_base").at("rotation_quat_xyzw").get<std::array<double, 4>>();
  const auto v = pose.at("velocity_mps").get<std::array<double, 3>>();
  const json& covariance = pose.at("covariance");
  const auto variance = [&covariance](std::size_t i) {
    return covariance.at(i * 7).is_number() ? covariance.at(i * 7).get<double>() : std::nan("");
  };
  const double heading = std::atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
  return format("%.3f s  %-12s  x %.3f  y %.3f  z %.3f m  heading %.2f deg  %.2f m/s  sigma %.3f m  %s",
                number(pose, "time_ns") * 1e-9, pose.at("status").get<std::string>().c_str(), p[0], p[1], p[2],
                heading * kDegrees, std::hypot(v[0], v[1], v[2]), std::sqrt(variance(0) + variance(1) + variance(2)),
                joined(pose.at("reasons")).c_str());
}

}  // namespace slamd::slamctl
