#include "daemon/health/thread_times.hpp"

#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace slamd {
namespace {

std::string first_line(const std::filesystem::path& path) {
  std::ifstream file{path};
  std::string line;
  std::getline(file, line);
  return line;
}

}  // namespace

std::map<std::string, ThreadTime> thread_times() {
  std::map<std::string, ThreadTime> times;
  std::error_code gone;  // a thread that ends meanwhile
  for (const auto& entry : std::filesystem::directory_iterator{"/proc/self/task", gone}) {
    const std::string name = first_line(entry.path() / "comm");
    if (name.empty()) continue;
    ThreadTime& time = times[name];
    time.cpu_s += std::strtod(first_line(entry.path() / "schedstat").c_str(), nullptr) * 1e-9;  // first: ns on a processor
    sched_param schedule{};
    const auto id = static_cast<pid_t>(std::strtol(entry.path().filename().c_str(), nullptr, 10));
    if (::sched_getparam(id, &schedule) == 0) time.priority = std::max(time.priority, schedule.sched_priority);
  }
  return times;
}

}  // namespace slamd
