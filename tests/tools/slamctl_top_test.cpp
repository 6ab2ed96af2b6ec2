// `slamctl top`: rates of two statuses, and the screen that is made of them.

#include <gtest/gtest.h>

#include "tools/slamctl/top.hpp"

namespace slamd::slamctl {
namespace {

using nlohmann::json;

json status(double time_s, int n) {
  json status = json::parse(R"({
    "version": "1.2.3",
    "pose": {"status": "DEGRADED", "reasons": ["no_imu"], "age_s": 0.25, "sigma_m": 0.1, "lidar_test_ratio": 0.4},
    "health": {
      "uptime_s": 12.5, "memory": {"resident_bytes": 1000000, "peak_bytes": 2000000},
      "sources": {"imu": {"state": "faulty", "reason": "silent", "rate_hz": 0.0, "age_s": null}},
      "rings": {"imu": {"size": 1, "high_water": 9, "capacity": 16}},
      "stages_ms": {"scan": {"count": 10, "p50": 4.0, "p90": 5.0, "p99": 6.0, "p999": 7.0, "max": 8.0}},
      "back_end": {"gnss": {"trust": "trusted"}},
      "threads": {"slamd-imu": {"priority": 60}, "slamd": {"priority": 0, "cpu_s": 1.0}}},
    "map": {"keyframes": 1, "points": 2, "bytes": 16}, "server": {"clients": 1}})");
  status["time_ns"] = static_cast<std::int64_t>(time_s * 1e9);
  status["pose"]["sequence"] = 400 * n;
  json& health = status["health"];
  health["threads"]["slamd-imu"]["cpu_s"] = 0.5 * n;
  health["sources"]["imu"]["lost"] = 10 * n;
  health["sources"]["imu"]["rejected"] = {{"crc", 3 * n}, {"cobs", n}};
  health["rings"]["imu"]["dropped"] = 6 * n;
  return status;
}

TEST(SlamctlTop, makes_rates_of_two_statuses) {
  const json figures = top_figures(status(10.0, 1), status(12.0, 2));
  EXPECT_DOUBLE_EQ(figures.at("interval_s"), 2.0);
  EXPECT_DOUBLE_EQ(figures.at("pose_rate_hz"), 200.0);
  EXPECT_DOUBLE_EQ(figures.at("cpu_percent").at("slamd-imu"), 25.0);
  EXPECT_DOUBLE_EQ(figures.at("cpu_percent").at("slamd"), 0.0);
  EXPECT_DOUBLE_EQ(figures.at("lost_per_s").at("imu"), 5.0);
  EXPECT_DOUBLE_EQ(figures.at("rejected_per_s").at("imu"), 2.0);
  EXPECT_DOUBLE_EQ(figures.at("dropped_per_s").at("imu"), 3.0);
}

TEST(SlamctlTop, gives_no_rate_to_what_began_anew) {
  const json figures = top_figures(status(10.0, 2), status(12.0, 1));
  EXPECT_DOUBLE_EQ(figures.at("pose_rate_hz"), 0.0);
  json first = status(10.0, 1);
  first["health"]["threads"].erase("slamd-imu");
  EXPECT_DOUBLE_EQ(top_figures(first, status(12.0, 2)).at("cpu_percent").at("slamd-imu"), 0.0);
}

TEST(SlamctlTop, shows_state_reason_gates_and_the_busiest_thread_first) {
  const json after = status(12.0, 2);
  const std::string text = top_text(after, top_figures(status(10.0, 1), after));
  for (const char* part : {"DEGRADED (no_imu)", "200.0 /s", "scan 0.40", "GPS trusted", "faulty (silent)", "25.0", "P99.9"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  }
  EXPECT_LT(text.find("slamd-imu"), text.find("\nslamd  "));
}

}  // namespace
}  // namespace slamd::slamctl
