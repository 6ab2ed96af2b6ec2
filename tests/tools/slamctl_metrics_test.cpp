// `slamctl metrics`: get_status as Prometheus' text.

#include <gtest/gtest.h>

#include "tools/slamctl/metrics.hpp"

namespace slamd::slamctl {
namespace {

using nlohmann::json;

json status() {
  return json::parse(R"({
    "pose": {"status": "DEGRADED", "reasons": ["no_imu"], "age_s": 0.25, "sequence": 7},
    "health": {
      "uptime_s": 12.5, "memory": {"resident_bytes": 1000000},
      "sources": {"imu": {"state": "faulty", "reason": "silent", "times_faulty": 2, "device": "d", "rate_hz": 0.0, "age_s": null, "received": 0, "lost": 3,
                          "rejected": {"crc": 4, "a\"b": 1}}},
      "rings": {"imu": {"dropped": 2, "high_water": 9}},
      "stages_ms": {"scan": {"count": 10, "sum": 50.0, "buckets": [[2.0, 0], [5.0, 7]], "p50": 4.0,
                    "p90": 5.0, "p99": 6.0, "p999": 7.0, "max": 8.0}},
      "threads": {"slamd-imu": {"cpu_s": 1.5, "priority": 60}}, "counts": {"scans": 10}},
    "map": {"keyframes": 1, "points": 2, "bytes": 16}, "server": {"clients": 1}})");
}

bool has_line(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

TEST(SlamctlMetrics, give_figures_with_names_labels_and_base_units) {
  const std::string text = metrics_text(status());
  for (const char* line :
       {"# TYPE slamd_status gauge", "slamd_status{status=\"DEGRADED\"} 1", "slamd_status{status=\"TRACKING\"} 0",
        "slamd_pose_age_seconds 0.25", "slamd_source_state{source=\"imu\",state=\"faulty\"} 1",
        "slamd_source_state{source=\"imu\",state=\"healthy\"} 0", "slamd_source_faulty_total{source=\"imu\"} 2", "slamd_source_lost_total{source=\"imu\"} 3",
        "slamd_source_rejected_total{source=\"imu\",cause=\"crc\"} 4", "slamd_ring_dropped_total{ring=\"imu\"} 2",
        "# TYPE slamd_stage_seconds histogram", "slamd_stage_seconds_bucket{stage=\"scan\",le=\"0.005\"} 7",
        "slamd_stage_seconds_bucket{stage=\"scan\",le=\"+Inf\"} 10", "slamd_stage_seconds_sum{stage=\"scan\"} 0.05",
        "slamd_stage_seconds_count{stage=\"scan\"} 10", "slamd_stage_longest_seconds{stage=\"scan\"} 0.008",
        "slamd_thread_cpu_seconds_total{thread=\"slamd-imu\"} 1.5",
        "slamd_events_total{event=\"scans\"} 10", "slamd_map_bytes 16", "slamd_clients 1"}) {
    EXPECT_TRUE(has_line(text, line)) << line << "\nin\n" << text;
  }
  EXPECT_EQ(text.back(), '\n');
}

TEST(SlamctlMetrics, leave_out_what_the_daemon_does_not_know) {
  EXPECT_EQ(metrics_text(status()).find("slamd_source_age_seconds"), std::string::npos);
}

TEST(SlamctlMetrics, escape_labels) {
  EXPECT_TRUE(has_line(metrics_text(status()), R"(slamd_source_rejected_total{source="imu",cause="a\"b"} 1)"));
}

}  // namespace
}  // namespace slamd::slamctl
