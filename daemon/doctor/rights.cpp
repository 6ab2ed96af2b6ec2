#include "daemon/doctor/rights.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>

namespace slamd::doctor {
namespace {

constexpr int kMayRaisePriority = 23, kMayRaiseLimits = 24;  // CAP_SYS_NICE, CAP_SYS_RESOURCE
constexpr std::array kRealTimeThreads{"slamd-imu", "slamd-lidar", "slamd-gnss", "slamd-estimator"};

std::string folder_of(const std::string& process) { return "/proc/" + process; }

std::string owner(const std::string& process) { return process == "self" ? "this user" : "slamd (" + process + ")"; }

bool has_capability(const HostFiles& host, const std::string& process, int bit) {
  const std::string mask = host.value_of(folder_of(process) + "/status", "CapEff:").value_or("0");
  return ((std::strtoull(mask.c_str(), nullptr, 16) >> bit) & 1) != 0;
}

std::optional<std::string> soft_limit(const HostFiles& host, const std::string& process, const std::string& name) {
  const std::vector<std::string> words = words_of(host.value_of(folder_of(process) + "/limits", name).value_or(""));
  return words.empty() ? std::nullopt : std::optional{words.front()};
}

std::string limits_line(const std::string& limit) {
  return "the unit slamd.service has it; for another user, with its name, in /etc/security/limits.d/slamd.conf: slamd - " +
         limit + ", then log in again";
}

struct Thread {
  std::string name;
  bool fifo = false;
};

/// From /proc/PID/task/TID/stat; the name stands in brackets and may have blanks, the policy is field 41.
std::optional<Thread> read_thread(const HostFiles& host, const std::string& folder) {
  constexpr std::size_t kPolicyAfterName = 38;
  const std::string stat = host.text(folder + "/stat").value_or("");
  const std::size_t open = stat.find('('), close = stat.rfind(')');
  if (open == std::string::npos || close == std::string::npos || close < open) return std::nullopt;
  const std::vector<std::string> fields = words_of(stat.substr(close + 1));
  if (fields.size() <= kPolicyAfterName) return std::nullopt;
  return Thread{stat.substr(open + 1, close - open - 1), fields[kPolicyAfterName] == "1"};
}

bool is_real_time(const std::string& name) {
  return std::find(kRealTimeThreads.begin(), kRealTimeThreads.end(), name) != kRealTimeThreads.end();
}

}  // namespace

std::vector<std::string> running_daemons(const HostFiles& host) {
  std::vector<std::string> found;
  for (const std::string& name : host.names("/proc")) {
    const bool process = std::isdigit(static_cast<unsigned char>(name[0])) != 0;
    if (process && host.word(folder_of(name) + "/comm") == "slamd") found.push_back(name);
  }
  return found;
}

Finding check_priority_limit(const HostFiles& host, const std::string& process, int priority) {
  const std::string subject = "RLIMIT_RTPRIO", wanted = std::to_string(priority);
  if (has_capability(host, process, kMayRaisePriority)) {
    return {Verdict::kRight, subject, owner(process) + " may use any priority (CAP_SYS_NICE)"};
  }
  const std::optional<std::string> limit = soft_limit(host, process, "Max realtime priority");
  if (!limit) return {Verdict::kUnknown, subject, "the limits of " + owner(process) + " cannot be read", "mount /proc"};
  const std::string found = owner(process) + " may use SCHED_FIFO up to " + *limit;
  if (*limit == "unlimited" || to_number(*limit).value_or(0) >= priority) return {Verdict::kRight, subject, found};
  return {Verdict::kWrong, subject, found + ", slamd wants " + wanted, limits_line("rtprio 80")};
}

Finding check_memory_limit(const HostFiles& host, const std::string& process) {
  const std::string subject = "RLIMIT_MEMLOCK";
  if (has_capability(host, process, kMayRaiseLimits)) {
    return {Verdict::kRight, subject, owner(process) + " may lock all its memory (CAP_SYS_RESOURCE)"};
  }
  const std::optional<std::string> limit = soft_limit(host, process, "Max locked memory");
  if (!limit) return {Verdict::kUnknown, subject, "the limits of " + owner(process) + " cannot be read", "mount /proc"};
  if (*limit == "unlimited") return {Verdict::kRight, subject, owner(process) + " may lock all its memory"};
  return {Verdict::kWrong, subject, owner(process) + " may lock " + *limit + " bytes only: pages may fault while driving",
          limits_line("memlock unlimited")};
}

Finding check_threads(const HostFiles& host, const std::string& process) {
  const std::string subject = "threads", tasks = folder_of(process) + "/task";
  std::string normal;
  std::size_t seen = 0;
  for (const std::string& task : host.names(tasks)) {
    const std::optional<Thread> thread = read_thread(host, tasks + "/" + task);
    if (!thread || !is_real_time(thread->name)) continue;
    ++seen;
    if (!thread->fifo) normal += (normal.empty() ? "" : " ") + thread->name;
  }
  if (seen == 0) return {Verdict::kUnknown, subject, owner(process) + " has no thread of a sensor yet, or hides them",
                         "ask again when it has started, or as root"};
  if (normal.empty()) return {Verdict::kRight, subject, owner(process) + " runs its sensors under SCHED_FIFO"};
  return {Verdict::kWrong, subject, owner(process) + " runs these threads without SCHED_FIFO: " + normal,
          "mend RLIMIT_RTPRIO, see that the priorities under real_time in slamd.yaml are not 0, and restart slamd"};
}

Finding check_locked_memory(const HostFiles& host, const std::string& process) {
  const std::string subject = "locked memory", status = folder_of(process) + "/status";
  const std::optional<std::int64_t> locked = to_number(host.value_of(status, "VmLck:").value_or(""));
  const std::optional<std::int64_t> resident = to_number(host.value_of(status, "VmRSS:").value_or(""));
  if (!locked || !resident) {
    return {Verdict::kUnknown, subject, "the memory of " + owner(process) + " cannot be read", "ask again as root"};
  }
  const std::string found = owner(process) + " has " + std::to_string(*locked) + " kB locked, " +
                            std::to_string(*resident) + " kB in use";
  if (*locked > 0 && *locked >= *resident) return {Verdict::kRight, subject, found};
  return {Verdict::kWrong, subject, found + ": the rest may fault while driving",
          "mend RLIMIT_MEMLOCK, see that real_time.lock_memory in slamd.yaml is true, and restart slamd"};
}

int estimator_cpu_of(const HostFiles& host, const std::string& process) {
  const std::string tasks = folder_of(process) + "/task";
  for (const std::string& task : host.names(tasks)) {
    const std::string folder = tasks + "/" + task;
    if (host.word(folder + "/comm") != "slamd-estimator") continue;
    const std::string cpus = host.value_of(folder + "/status", "Cpus_allowed_list:").value_or("");
    const bool pinned = !cpus.empty() && cpus.find_first_of(",-") == std::string::npos;
    return pinned ? static_cast<int>(to_number(cpus).value_or(-1)) : -1;
  }
  return -1;
}

}  // namespace slamd::doctor
