#include "daemon/doctor/machine.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace slamd::doctor {
namespace {

constexpr std::int64_t kWakeLimitUs = 100;  // of the 5 ms between two IMU samples
const std::string kCpus = "/sys/devices/system/cpu/";

std::vector<std::string> cpu_folders(const HostFiles& host) {
  std::vector<std::string> folders;
  for (const std::string& name : host.names(kCpus)) {
    if (name.size() > 3 && name.starts_with("cpu") && std::isdigit(static_cast<unsigned char>(name[3])) != 0) {
      folders.push_back(kCpus + name);
    }
  }
  return folders;
}

struct IdleState {
  std::string name;
  std::int64_t wake_us = -1;  // -1: no CPU tells of any
};

/// The allowed idle state, of any CPU, that takes longest to leave.
IdleState deepest_state(const HostFiles& host) {
  IdleState deepest;
  for (const std::string& cpu : cpu_folders(host)) {
    for (const std::string& state : host.names(cpu + "/cpuidle")) {
      const std::string folder = cpu + "/cpuidle/" + state;
      const std::int64_t wake_us = host.number(folder + "/latency").value_or(-1);
      if (host.number(folder + "/disable").value_or(0) != 0 || wake_us <= deepest.wake_us) continue;
      deepest = {host.word(folder + "/name").value_or(state), wake_us};
    }
  }
  return deepest;
}

/// Microseconds, as four bytes of this machine's order.
std::optional<std::int64_t> wake_limit_us(const HostFiles& host) {
  const std::optional<std::string> bytes = host.text("/dev/cpu_dma_latency");
  std::int32_t limit = 0;
  if (!bytes || bytes->size() < sizeof limit) return std::nullopt;
  std::memcpy(&limit, bytes->data(), sizeof limit);
  return limit;
}

}  // namespace

Finding check_kernel(const HostFiles& host) {
  const std::optional<std::string> version = host.text("/proc/version");
  if (!version) return {Verdict::kUnknown, "kernel", "/proc/version cannot be read", "mount /proc"};
  const std::vector<std::string> words = words_of(*version);
  const std::string release = words.size() > 2 ? words[2] : "of unknown release";
  const bool real_time = host.number("/sys/kernel/realtime").value_or(0) == 1 ||
                         std::find(words.begin(), words.end(), "PREEMPT_RT") != words.end();
  if (real_time) return {Verdict::kRight, "kernel", release + " is PREEMPT_RT"};
  return {Verdict::kWrong, "kernel", release + " is not PREEMPT_RT: it may hold up any thread for milliseconds",
          "apt install linux-image-rt-amd64, then start the PC again"};
}

Finding check_governor(const HostFiles& host) {
  std::string slow;
  std::size_t told = 0;
  for (const std::string& cpu : cpu_folders(host)) {
    const std::optional<std::string> governor = host.word(cpu + "/cpufreq/scaling_governor");
    told += governor ? 1 : 0;
    if (governor && *governor != "performance" && slow.empty()) slow = cpu.substr(kCpus.size()) + " has " + *governor;
  }
  if (told == 0) return {Verdict::kUnknown, "CPU governor", "the kernel does not set the CPUs' frequency here",
                         "nothing in a virtual machine; on a PC choose full performance in its firmware"};
  if (slow.empty()) return {Verdict::kRight, "CPU governor", "performance on all CPUs"};
  return {Verdict::kWrong, "CPU governor", slow + ": the CPU runs slow when work comes",
          "cpupower frequency-set -g performance (package linux-cpupower); for good: a unit that runs it at the start"};
}

Finding check_idle_states(const HostFiles& host) {
  const std::string subject = "CPU idle";
  const IdleState deepest = deepest_state(host);
  if (deepest.wake_us < 0) return {Verdict::kUnknown, subject, "the kernel does not tell of idle states here",
                                   "nothing in a virtual machine; on a PC see C-states in its firmware"};
  const std::string found = "deepest allowed state " + deepest.name + " takes " + std::to_string(deepest.wake_us) +
                            " us to leave";
  if (deepest.wake_us <= kWakeLimitUs) return {Verdict::kRight, subject, found};
  const std::optional<std::int64_t> limit = wake_limit_us(host);
  if (limit && *limit <= kWakeLimitUs) {
    return {Verdict::kRight, subject, found + ", but cpu_dma_latency holds " + std::to_string(*limit) + " us"};
  }
  return {Verdict::kWrong, subject,
          found + (limit ? " and cpu_dma_latency permits it" : "; whether cpu_dma_latency forbids it only root may read"),
          "cpupower idle-set -D " + std::to_string(kWakeLimitUs) +
              " (package linux-cpupower); slamd itself forbids it while it runs (real_time.cpu_latency_us), where udev's 60-slamd.rules let it"};
}

Finding check_clock_source(const HostFiles& host) {
  constexpr std::array kFast{"tsc", "kvm-clock", "hyperv_clocksource_tsc_page", "arch_sys_counter"};
  const std::string folder = "/sys/devices/system/clocksource/clocksource0/", subject = "clock source";
  const std::optional<std::string> current = host.word(folder + "current_clocksource");
  if (!current) return {Verdict::kUnknown, subject, folder + "current_clocksource cannot be read", "mount /sys"};
  if (std::find(kFast.begin(), kFast.end(), *current) != kFast.end()) return {Verdict::kRight, subject, *current};
  const std::vector<std::string> available = words_of(host.text(folder + "available_clocksource").value_or(""));
  const bool has_tsc = std::find(available.begin(), available.end(), "tsc") != available.end();
  return {Verdict::kWrong, subject, *current + ": each look at the clock takes about a microsecond and a system call",
          has_tsc ? "echo tsc > " + folder + "current_clocksource; for good: the kernel's option clocksource=tsc"
                  : "the kernel has put tsc aside: dmesg | grep -i tsc says why; when the hardware is sound, tsc=reliable"};
}

}  // namespace slamd::doctor
