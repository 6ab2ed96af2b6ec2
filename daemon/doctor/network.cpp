#include "daemon/doctor/network.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace slamd::doctor {
namespace {

/// /proc/net/route writes addresses as hexadecimal words in network order of memory, like in_addr.
std::uint32_t hex_word(const std::string& text) { return static_cast<std::uint32_t>(std::strtoul(text.c_str(), nullptr, 16)); }

bool is_number(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// "enp3s0" or one of its queues, "enp3s0-rx-0".
bool names_port(const std::string& word, const std::string& port) { return word == port || word.starts_with(port + "-"); }

/// Numbers of the port's interrupts: those of its device and those that carry its name.
std::vector<std::string> interrupts_of(const HostFiles& host, const std::string& port) {
  std::vector<std::string> numbers = host.names("/sys/class/net/" + port + "/device/msi_irqs");
  for (const std::string& line : lines_of(host.text("/proc/interrupts").value_or(""))) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() < 2 || !names_port(words.back(), port)) continue;
    const std::string number = words.front().substr(0, words.front().find(':'));
    if (is_number(number) && std::find(numbers.begin(), numbers.end(), number) == numbers.end()) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

/// Those of `numbers` that may run on `cpu`, with blanks between.
std::string running_on(const HostFiles& host, const std::vector<std::string>& numbers, int cpu) {
  std::string those;
  for (const std::string& number : numbers) {
    const std::string cpus = host.word("/proc/irq/" + number + "/smp_affinity_list").value_or("");
    if (list_has(cpus, cpu)) those += (those.empty() ? "" : " ") + number;
  }
  return those;
}

}  // namespace

Finding check_socket_buffer(const HostFiles& host, std::int64_t wanted_bytes) {
  const std::string subject = "socket buffer", wanted = std::to_string(wanted_bytes);
  const std::optional<std::int64_t> most = host.number("/proc/sys/net/core/rmem_max");
  if (!most) return {Verdict::kUnknown, subject, "net.core.rmem_max cannot be read", "mount /proc"};
  const std::string found = "net.core.rmem_max is " + std::to_string(*most) + " bytes";
  if (*most >= wanted_bytes) return {Verdict::kRight, subject, found + ", the LiDAR's socket asks for " + wanted};
  return {Verdict::kWrong, subject, found + ", the LiDAR's socket asks for " + wanted + ": a short stall loses packets",
          "sysctl -w net.core.rmem_max=" + wanted + "; for good: that line in /etc/sysctl.d/slamd.conf"};
}

std::optional<std::string> port_towards(const HostFiles& host, const std::string& address) {
  in_addr wanted{};
  if (inet_pton(AF_INET, address.c_str(), &wanted) != 1) return std::nullopt;
  std::optional<std::string> port;
  std::uint32_t closest = 0;
  for (const std::string& line : lines_of(host.text("/proc/net/route").value_or(""))) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() < 8 || words[0] == "Iface") continue;
    const std::uint32_t mask = ntohl(hex_word(words[7]));
    const bool own_network = hex_word(words[2]) == 0 && mask > closest;  // without a gateway
    if (!own_network || (ntohl(wanted.s_addr) & mask) != ntohl(hex_word(words[1]))) continue;
    port = words[0];
    closest = mask;
  }
  return port;
}

Finding check_port_interrupts(const HostFiles& host, const std::string& lidar_address, int estimator_cpu) {
  const std::string subject = "LiDAR's port";
  const std::optional<std::string> port = port_towards(host, lidar_address);
  if (!port) return {Verdict::kUnknown, subject, "no network port is in the network of the LiDAR, " + lidar_address,
                     "ip address add an address of that network to the port, or name the LiDAR's own address"};
  const std::vector<std::string> interrupts = interrupts_of(host, *port);
  if (interrupts.empty()) return {Verdict::kUnknown, subject, *port + ": the kernel does not tell its interrupts",
                                  "grep for its driver in /proc/interrupts"};
  if (estimator_cpu < 0) return {Verdict::kRight, subject, *port + ": its interrupts may run anywhere, so may the estimator"};
  const std::string cpu = std::to_string(estimator_cpu), those = running_on(host, interrupts, estimator_cpu);
  if (those.empty()) return {Verdict::kRight, subject, *port + ": no interrupt on CPU " + cpu + ", the estimator's"};
  return {Verdict::kWrong, subject, *port + ": interrupts " + those + " may run on CPU " + cpu + ", the estimator's",
          "stop irqbalance or ban that CPU for it, then write the other CPUs into /proc/irq/NUMBER/smp_affinity_list"};
}

}  // namespace slamd::doctor
