// What `slamctl doctor` makes of get_status.

#include <gtest/gtest.h>

#include "tools/slamctl/daemon_findings.hpp"

namespace slamd::slamctl {
namespace {

using doctor::Finding;
using doctor::Verdict;
using nlohmann::json;

json good_status() {
  return json::parse(R"({
    "pose": {"status": "TRACKING", "reasons": []},
    "health": {
      "sources": {"lidar": {"state": "healthy", "reason": "none", "device": "udp:0.0.0.0:2368"},
                  "imu": {"state": "healthy", "reason": "none", "device": "/dev/slamd-imu"},
                  "gnss": {"state": "healthy", "reason": "none", "device": "/dev/slamd-gps"}},
      "rings": {"imu": {"dropped": 0}, "lidar": {"dropped": 0}}}})");
}

Finding finding(const json& status, const std::string& subject) {
  for (const Finding& each : daemon_findings(status)) {
    if (each.subject == subject) return each;
  }
  ADD_FAILURE() << "nothing was found of " << subject;
  return {};
}

TEST(SlamctlFindings, say_that_a_healthy_daemon_is_right) {
  const doctor::Findings findings = daemon_findings(good_status());
  EXPECT_EQ(findings.size(), 5u);
  for (const Finding& each : findings) EXPECT_EQ(each.verdict, Verdict::kRight) << each.subject;
  EXPECT_EQ(findings_json(findings).at("right"), true);
}

TEST(SlamctlFindings, name_the_reasons_of_a_pose_that_does_not_track) {
  json status = good_status();
  status["pose"] = {{"status", "LOST"}, {"reasons", {"no_lidar", "no_imu"}}};
  EXPECT_EQ(finding(status, "pose").found, "slamd is LOST no_lidar no_imu");
  EXPECT_EQ(finding(status, "pose").verdict, Verdict::kWrong);
}

TEST(SlamctlFindings, name_the_sensor_that_is_not_healthy_and_its_remedy_by_reason) {
  for (const char* reason : {"no_device", "silent", "refused", "no_fix", "slow", "unused", "unsure_clock"}) {
    json status = good_status();
    status["health"]["sources"]["gnss"]["state"] = "faulty";
    status["health"]["sources"]["gnss"]["reason"] = reason;
    const Finding told = finding(status, "gnss");
    EXPECT_EQ(told.verdict, Verdict::kWrong);
    EXPECT_EQ(told.found, "faulty (" + std::string{reason} + "), /dev/slamd-gps");
    EXPECT_FALSE(told.remedy.empty());
  }
}

TEST(SlamctlFindings, hold_a_sensor_that_is_not_configured_against_nobody) {
  json status = good_status();
  status["health"]["sources"]["gnss"] = {{"state", "absent"}, {"reason", "no_device"}, {"device", ""}};
  EXPECT_EQ(finding(status, "gnss").verdict, Verdict::kUnknown);
  EXPECT_EQ(findings_json(daemon_findings(status)).at("right"), true);
}

TEST(SlamctlFindings, count_what_was_dropped_between_threads) {
  json status = good_status();
  status["health"]["rings"]["imu"]["dropped"] = 12;
  const Finding told = finding(status, "rings");
  EXPECT_EQ(told.verdict, Verdict::kWrong);
  EXPECT_NE(told.found.find(" imu 12"), std::string::npos);
  const json object = findings_json({told});
  EXPECT_EQ(object.at("right"), false);
  EXPECT_EQ(object.at("findings").at(0).at("verdict"), "wrong");
  EXPECT_EQ(object.at("findings").at(0).at("subject"), "rings");
}

}  // namespace
}  // namespace slamd::slamctl
