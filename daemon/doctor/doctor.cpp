#include "daemon/doctor/doctor.hpp"

#include <algorithm>

#include "daemon/doctor/machine.hpp"
#include "daemon/doctor/network.hpp"
#include "daemon/doctor/rights.hpp"

namespace slamd::doctor {
namespace {

Findings check_host(const HostFiles& host, const Wanted& wanted) {
  return {check_kernel(host),
          check_governor(host),
          check_idle_states(host),
          check_clock_source(host),
          check_socket_buffer(host, wanted.receive_buffer_bytes),
          check_port_interrupts(host, wanted.lidar_address, wanted.estimator_cpu)};
}

void add_limits(Findings& findings, const HostFiles& host, const std::string& process, int priority) {
  findings.push_back(check_priority_limit(host, process, priority));
  findings.push_back(check_memory_limit(host, process));
}

const char* mark(Verdict verdict) {
  return verdict == Verdict::kRight ? "right  " : verdict == Verdict::kWrong ? "WRONG  " : "unknown";
}

}  // namespace

Findings check_machine(const HostFiles& host, const Wanted& wanted) {
  Findings findings = check_host(host, wanted);
  add_limits(findings, host, "self", wanted.priority);
  return findings;
}

Findings check_machine_and_daemons(const HostFiles& host, Wanted wanted) {
  const std::vector<std::string> daemons = running_daemons(host);
  if (daemons.empty()) return check_machine(host, wanted);
  if (wanted.estimator_cpu < 0) wanted.estimator_cpu = estimator_cpu_of(host, daemons.front());
  Findings findings = check_host(host, wanted);
  for (const std::string& daemon : daemons) {
    add_limits(findings, host, daemon, wanted.priority);
    findings.push_back(check_threads(host, daemon));
    findings.push_back(check_locked_memory(host, daemon));
  }
  return findings;
}

std::string text(const Findings& findings) {
  constexpr std::size_t kSubjectWidth = 15;
  std::string lines;
  for (const Finding& finding : findings) {
    std::string subject = finding.subject;
    subject.resize(std::max(subject.size(), kSubjectWidth), ' ');
    lines += std::string{mark(finding.verdict)} + "  " + subject + " " + finding.found + '\n';
    if (!finding.remedy.empty()) lines += std::string(9, ' ') + "-> " + finding.remedy + '\n';
  }
  return lines;
}

bool all_right(const Findings& findings) {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.verdict == Verdict::kWrong; });
}

}  // namespace slamd::doctor
