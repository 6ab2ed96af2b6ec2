// daemon/doctor over made-up trees of /proc, /sys and /dev: a machine where all is right, each thing wrong, and nothing there.

#include "daemon/doctor/doctor.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "daemon/config/config.hpp"
#include "daemon/doctor/network.hpp"
#include "daemon/doctor/rights.hpp"
#include "daemon/rt_check.hpp"

namespace slamd::doctor {
namespace {

const std::string kCpu0 = "/sys/devices/system/cpu/cpu0";
const std::string kClock = "/sys/devices/system/clocksource/clocksource0/";

/// As /proc/PID/task/TID/stat: policy 1 is SCHED_FIFO.
std::string stat_of(const std::string& name, int policy) {
  return "7 (" + name + ") S 1 7 7 0 -1 4194304 1 0 0 0 0 0 0 0 -61 0 5 0 100 1 1 18446744073709551615 1 1 1 0 0 0 0 4096 0 0 0 0 " +
         "-1 1 60 " + std::to_string(policy) + " 0 0 0 0 0 0 0 0 0 0 0\n";
}

std::string limits(const std::string& priority, const std::string& memory) {
  return "Limit                     Soft Limit           Hard Limit           Units     \n"
         "Max locked memory         " + memory + "              " + memory + "              bytes     \n"
         "Max realtime priority     " + priority + "                   " + priority + "                    \n";
}

class Doctor : public ::testing::Test {
 protected:
  Doctor() {
    std::string folder = std::filesystem::temp_directory_path() / "slamd_doctor_XXXXXX";
    root_ = mkdtemp(folder.data());
  }
  ~Doctor() override { std::filesystem::remove_all(root_); }

  void write(const std::string& path, const std::string& content) const {
    const std::filesystem::path file = root_ + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream{file, std::ios::binary} << content;
  }

  /// A PC as it should be, without slamd.
  void make_right_machine() const {
    write("/proc/version", "Linux version 6.1.0-rt (x@y) (gcc) #1 SMP PREEMPT_RT Debian 6.1.1 (2026-01-01)\n");
    write("/sys/kernel/realtime", "1\n");
    for (const std::string cpu : {"cpu0", "cpu1"}) {
      write("/sys/devices/system/cpu/" + cpu + "/cpufreq/scaling_governor", "performance\n");
    }
    write(kCpu0 + "/cpuidle/state0/latency", "0\n");
    write(kCpu0 + "/cpuidle/state1/latency", "2\n");
    write(kCpu0 + "/cpuidle/state1/name", "C1\n");
    write(kClock + "current_clocksource", "tsc\n");
    write(kClock + "available_clocksource", "tsc hpet acpi_pm \n");
    write("/proc/sys/net/core/rmem_max", "8388608\n");
    write("/proc/net/route",
          "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\tMTU\tWindow\tIRTT\n"
          "wlan0\t00000000\t010200C0\t0003\t0\t0\t0\t00000000\t0\t0\t0\n"
          "enp3s0\t0001A8C0\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n");
    write("/proc/interrupts",
          "            CPU0       CPU1\n  41:  5  0  PCI-MSI 0-edge  enp3s0-rx-0\n  42:  5  0  PCI-MSI 1-edge  wlan0\nNMI: 0 0 x\n");
    write("/proc/irq/41/smp_affinity_list", "0-1\n");
    write_process("self", limits("80", "unlimited"), "bash");
  }

  void write_process(const std::string& id, const std::string& its_limits, const std::string& name) const {
    write("/proc/" + id + "/limits", its_limits);
    write("/proc/" + id + "/comm", name + "\n");
    write("/proc/" + id + "/status", "Name:\t" + name + "\nVmLck:\t  60000 kB\nVmRSS:\t  50000 kB\nCapEff:\t0000000000000000\n");
  }

  void write_thread(const std::string& process, const std::string& id, const std::string& name, int policy) const {
    const std::string folder = "/proc/" + process + "/task/" + id;
    write(folder + "/stat", stat_of(name, policy));
    write(folder + "/comm", name + "\n");
    write(folder + "/status", "Cpus_allowed_list:\t1\n");
  }

  void make_daemon() const {
    write_process("812", limits("80", "unlimited"), "slamd");
    write_thread("812", "812", "slamd", 0);
    write_thread("812", "813", "slamd-imu", 1);
    write_thread("812", "814", "slamd-estimator", 1);
    write("/proc/irq/41/smp_affinity_list", "0\n");
  }

  Finding finding(const std::string& subject) const {
    for (const Finding& each : check_machine_and_daemons(host(), {})) {
      if (each.subject == subject) return each;
    }
    ADD_FAILURE() << "nothing was found of " << subject;
    return {};
  }

  void expect_wrong(const std::string& subject, const std::string& found, const std::string& remedy) const {
    const Finding told = finding(subject);
    EXPECT_EQ(told.verdict, Verdict::kWrong) << told.found;
    EXPECT_NE(told.found.find(found), std::string::npos) << told.found;
    EXPECT_NE(told.remedy.find(remedy), std::string::npos) << told.remedy;
  }

  HostFiles host() const { return HostFiles{root_}; }

  std::string root_;
};

TEST_F(Doctor, finds_nothing_wrong_and_nothing_unknown_on_a_right_machine) {
  make_right_machine();
  const Findings without = check_machine(host(), {});
  EXPECT_EQ(without.size(), 8u);
  make_daemon();
  const Findings beside = check_machine_and_daemons(host(), {});
  EXPECT_EQ(beside.size(), 10u);
  for (const Findings& findings : {without, beside}) {
    for (const Finding& each : findings) {
      EXPECT_EQ(each.verdict, Verdict::kRight) << each.subject << ": " << each.found;
      EXPECT_TRUE(each.remedy.empty()) << each.subject;
    }
  }
}

TEST_F(Doctor, knows_nothing_of_an_empty_root_and_holds_it_against_nobody) {
  const Findings findings = check_machine_and_daemons(host(), {});
  EXPECT_EQ(findings.size(), 8u);
  for (const Finding& each : findings) {
    EXPECT_EQ(each.verdict, Verdict::kUnknown) << each.subject << ": " << each.found;
    EXPECT_FALSE(each.remedy.empty()) << each.subject;
  }
  EXPECT_TRUE(all_right(findings));
}

TEST_F(Doctor, tells_a_kernel_without_real_time) {
  make_right_machine();
  write("/sys/kernel/realtime", "0\n");
  write("/proc/version", "Linux version 6.1.0-18-amd64 (x@y) (gcc) #1 SMP PREEMPT_DYNAMIC Debian 6.1.76\n");
  expect_wrong("kernel", "6.1.0-18-amd64 is not PREEMPT_RT", "linux-image-rt-amd64");
}

TEST_F(Doctor, tells_the_cpu_whose_governor_saves_power) {
  make_right_machine();
  write("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
  expect_wrong("CPU governor", "cpu1 has powersave", "cpupower frequency-set -g performance");
}

TEST_F(Doctor, tells_deep_idle_states_unless_disabled_or_forbidden_through_cpu_dma_latency) {
  make_right_machine();
  write(kCpu0 + "/cpuidle/state2/latency", "890\n");
  write(kCpu0 + "/cpuidle/state2/name", "C10\n");
  expect_wrong("CPU idle", "C10 takes 890 us", "cpupower idle-set -D 100");
  write("/dev/cpu_dma_latency", std::string{"\x00\x94\x35\x77", 4});  // 2,000,000,000 us: nobody holds it
  expect_wrong("CPU idle", "cpu_dma_latency permits it", "cpupower idle-set -D 100");
  write("/dev/cpu_dma_latency", std::string{"\x0a\x00\x00\x00", 4});
  EXPECT_EQ(finding("CPU idle").verdict, Verdict::kRight);
  std::filesystem::remove(root_ + "/dev/cpu_dma_latency");
  write(kCpu0 + "/cpuidle/state2/disable", "1\n");
  EXPECT_EQ(finding("CPU idle").verdict, Verdict::kRight);
}

TEST_F(Doctor, tells_a_slow_clock_and_whether_tsc_can_be_chosen) {
  make_right_machine();
  write(kClock + "current_clocksource", "hpet\n");
  expect_wrong("clock source", "hpet", "echo tsc > ");
  write(kClock + "available_clocksource", "hpet acpi_pm \n");
  expect_wrong("clock source", "hpet", "dmesg");
}

TEST_F(Doctor, tells_a_socket_buffer_below_what_the_lidar_asks_for) {
  make_right_machine();
  write("/proc/sys/net/core/rmem_max", "212992\n");
  expect_wrong("socket buffer", "212992", "sysctl -w net.core.rmem_max=4194304");
  EXPECT_EQ(check_socket_buffer(host(), 212992).verdict, Verdict::kRight);
}

TEST_F(Doctor, finds_the_port_by_the_network_of_the_lidar_and_never_by_a_gateway) {
  make_right_machine();
  EXPECT_EQ(port_towards(host(), "192.168.1.201"), "enp3s0");
  EXPECT_EQ(port_towards(host(), "192.168.2.201"), std::nullopt);
  EXPECT_EQ(port_towards(host(), "not an address"), std::nullopt);
}

TEST_F(Doctor, tells_interrupts_of_the_port_on_the_estimators_cpu_alone) {
  make_right_machine();
  const Finding shared = check_port_interrupts(host(), "192.168.1.201", 1);
  EXPECT_EQ(shared.verdict, Verdict::kWrong);
  EXPECT_NE(shared.found.find("enp3s0: interrupts 41 may run on CPU 1"), std::string::npos) << shared.found;
  EXPECT_EQ(check_port_interrupts(host(), "192.168.1.201", 2).verdict, Verdict::kRight);
  write("/sys/class/net/enp3s0/device/msi_irqs/55", "msix\n");  // of the device, under another name
  write("/proc/irq/55/smp_affinity_list", "2,4-5\n");
  EXPECT_EQ(check_port_interrupts(host(), "192.168.1.201", 2).verdict, Verdict::kWrong);
  EXPECT_EQ(check_port_interrupts(host(), "192.168.1.201", 3).verdict, Verdict::kRight);
  make_daemon();  // whose estimator is pinned to CPU 1
  write("/proc/irq/41/smp_affinity_list", "0-1\n");
  expect_wrong("LiDAR's port", "CPU 1", "smp_affinity_list");
}

TEST_F(Doctor, tells_limits_of_the_caller_unless_a_capability_stands_above_them) {
  make_right_machine();
  write_process("self", limits("20", "8388608"), "bash");
  expect_wrong("RLIMIT_RTPRIO", "this user may use SCHED_FIFO up to 20, slamd wants 60", "slamd - rtprio 80");
  expect_wrong("RLIMIT_MEMLOCK", "8388608 bytes only", "slamd - memlock unlimited");
  write("/proc/self/status", "CapEff:\t0000000001800000\n");
  EXPECT_EQ(finding("RLIMIT_RTPRIO").verdict, Verdict::kRight);
  EXPECT_EQ(finding("RLIMIT_MEMLOCK").verdict, Verdict::kRight);
  write("/proc/self/status", "CapEff:\t0000000000004000\n");  // CAP_IPC_LOCK: only what there is at the start is locked
  EXPECT_EQ(finding("RLIMIT_MEMLOCK").verdict, Verdict::kWrong);
}

TEST_F(Doctor, tells_what_a_running_daemon_has_not_obtained) {
  make_right_machine();
  make_daemon();
  write_process("812", limits("0", "65536"), "slamd");
  write_thread("812", "813", "slamd-imu", 0);
  write("/proc/812/status", "VmLck:\t       0 kB\nVmRSS:\t  50000 kB\n");
  expect_wrong("RLIMIT_RTPRIO", "slamd (812)", "rtprio");
  expect_wrong("RLIMIT_MEMLOCK", "slamd (812)", "memlock");
  expect_wrong("threads", "without SCHED_FIFO: slamd-imu", "restart slamd");
  expect_wrong("locked memory", "0 kB locked, 50000 kB in use", "real_time.lock_memory");
}

TEST_F(Doctor, asks_the_machine_for_what_the_configuration_says) {
  Config config;
  const Wanted by_default = wanted_of(config), assumed;
  EXPECT_EQ(by_default.lidar_address, assumed.lidar_address);
  EXPECT_EQ(by_default.receive_buffer_bytes, assumed.receive_buffer_bytes);
  EXPECT_EQ(by_default.priority, assumed.priority);
  EXPECT_EQ(by_default.estimator_cpu, assumed.estimator_cpu);
  config.lidar.source_address = "10.0.0.5";
  config.lidar.receive_buffer_bytes = 1 << 20;
  config.real_time.gnss_priority = 77;
  config.real_time.estimator_cpu = 3;
  const Wanted wanted = wanted_of(config);
  EXPECT_EQ(wanted.lidar_address, "10.0.0.5");
  EXPECT_EQ(wanted.receive_buffer_bytes, 1 << 20);
  EXPECT_EQ(wanted.priority, 77);
  EXPECT_EQ(wanted.estimator_cpu, 3);
}

TEST_F(Doctor, exits_with_1_exactly_when_its_text_names_something_wrong) {
  std::ostringstream out;
  const Config config;
  const int code = check_real_time(config, out);
  EXPECT_EQ(code, out.str().find("WRONG") == std::string::npos ? 0 : 1);
  EXPECT_NE(out.str().find("kernel"), std::string::npos);
  EXPECT_EQ(text({{Verdict::kWrong, "kernel", "old", "renew it"}}), "WRONG    kernel          old\n         -> renew it\n");
  EXPECT_FALSE(all_right({{Verdict::kWrong, "kernel", "old", "renew it"}}));
}

}  // namespace
}  // namespace slamd::doctor
