#include "tools/slamctl/daemon_findings.hpp"

#include <cstdint>
#include <string>

#include "daemon/doctor/doctor.hpp"

namespace slamd::slamctl {
namespace {

using doctor::Finding;
using doctor::Verdict;
using nlohmann::json;

std::string remedy_for_source(const std::string& reason) {
  if (reason == "no_device") return "plug it in; its device in slamd.yaml must be the one under /dev, readable for slamd";
  if (reason == "silent") return "see to its power and cable, and that device, port and speed in slamd.yaml are its own";
  if (reason == "no_fix") return "see to the antenna and its view of the sky";
  if (reason == "slow" || reason == "lossy") return "see to its cable and network, its own settings, and the processor's load";
  if (reason == "unused" || reason == "doubted") return "it contradicts the others: see to its mounting (vehicle in slamd.yaml), or replace it";
  if (reason == "unsure_clock") return "wait some seconds; if it stays, see to the sensor's clock and power";
  return "something else speaks there: `slamctl status --json` counts what was refused by cause";
}

Finding pose_finding(const json& pose) {
  const std::string status = pose.at("status");
  std::string found = "slamd is " + status;
  for (const json& reason : pose.at("reasons")) found += " " + reason.get<std::string>();
  if (status == "TRACKING") return {Verdict::kRight, "pose", found};
  return {Verdict::kWrong, "pose", found,
          status == "INITIALISING" ? "let the vehicle stand for a second, with LiDAR and IMU healthy"
                                   : "mend the sensors below; journalctl -u slamd tells since when"};
}

Finding source_finding(const std::string& name, const json& source) {
  const std::string state = source.at("state"), reason = source.at("reason"), device = source.at("device");
  if (device.empty()) return {Verdict::kUnknown, name, "none is configured", "its device in slamd.yaml, if there is one"};
  if (state == "healthy") return {Verdict::kRight, name, state + ", " + device};
  return {Verdict::kWrong, name, state + " (" + reason + "), " + device, remedy_for_source(reason)};
}

Finding ring_finding(const json& rings) {
  std::string dropped;
  for (const auto& [name, ring] : rings.items()) {
    const auto count = ring.at("dropped").get<std::uint64_t>();
    if (count > 0) dropped += " " + name + " " + std::to_string(count);
  }
  if (dropped.empty()) return {Verdict::kRight, "rings", "nothing was dropped between slamd's threads"};
  return {Verdict::kWrong, "rings", "dropped between slamd's threads since its start:" + dropped,
          "the processor is too slow or busy: mend what is wrong with the machine, see top -H"};
}

const char* name(Verdict verdict) {
  return verdict == Verdict::kRight ? "right" : verdict == Verdict::kWrong ? "wrong" : "unknown";
}

}  // namespace

doctor::Findings daemon_findings(const json& status) {
  const json& health = status.at("health");
  doctor::Findings findings{pose_finding(status.at("pose"))};
  for (const auto& [source, told] : health.at("sources").items()) findings.push_back(source_finding(source, told));
  findings.push_back(ring_finding(health.at("rings")));
  return findings;
}

json findings_json(const doctor::Findings& findings) {
  json list = json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"verdict", name(finding.verdict)},
                    {"subject", finding.subject},
                    {"found", finding.found},
                    {"remedy", finding.remedy}});
  }
  return {{"right", doctor::all_right(findings)}, {"findings", std::move(list)}};
}

}  // namespace slamd::slamctl
