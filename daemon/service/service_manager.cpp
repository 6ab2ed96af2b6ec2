#include "daemon/service/service_manager.hpp"

#include <fcntl.h>
#include <systemd/sd-daemon.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace slamd {
namespace {

constexpr const char* kSocketName = "socket";  // FileDescriptorName= of slamd.socket
constexpr const char* kPageName = "pose-page";

void notify(const std::string& message) { sd_notify(0, message.c_str()); }

}  // namespace

HandedOver ServiceManager::take_descriptors() {
  HandedOver taken;
  char** names = nullptr;
  const int count = sd_listen_fds_with_names(1, &names);
  for (int i = 0; i < count; ++i) {
    UniqueFd fd{SD_LISTEN_FDS_START + i};
    if (std::strcmp(names[i], kSocketName) == 0) taken.listening = std::move(fd);
    if (std::strcmp(names[i], kPageName) == 0) taken.pose_page = std::move(fd);
    std::free(names[i]);
  }
  std::free(names);
  return taken;
}

std::optional<Duration> ServiceManager::watchdog_period() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) <= 0) return std::nullopt;
  return std::chrono::microseconds{period_us};
}

void ServiceManager::ready() { notify("READY=1"); }

void ServiceManager::alive() { notify("WATCHDOG=1"); }

void ServiceManager::reloading() { notify("RELOADING=1"); }

void ServiceManager::stopping() { notify("STOPPING=1"); }

void ServiceManager::tell(const std::string& status) {
  if (status == told_) return;
  told_ = status;
  notify("STATUS=" + status);
}

void ServiceManager::keep_pose_page(int memfd) {
  notify(std::string{"FDSTOREREMOVE=1\nFDNAME="} + kPageName);
  const std::string message = std::string{"FDSTORE=1\nFDPOLL=0\nFDNAME="} + kPageName;
  sd_pid_notify_with_fds(0, 0, message.c_str(), &memfd, 1);
}

}  // namespace slamd
