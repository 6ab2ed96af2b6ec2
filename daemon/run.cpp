#include "daemon/run.hpp"

#include <algorithm>
#include <csignal>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "daemon/app.hpp"
#include "daemon/server/host_clock.hpp"
#include "daemon/service/service_manager.hpp"

namespace slamd {
namespace {

constexpr timespec kLookPeriod{0, 100'000'000};
constexpr Duration kTellPeriod = std::chrono::seconds{1};
constexpr std::size_t kMaxFaultsTold = 10;  // of a file that a reload refuses

/// What the daemon waits for, blocked in every thread and taken by the main one.
sigset_t block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

/// A running app under its service manager.
class Service {
 public:
  Service(const Launch& launch, App& app) : launch_{launch}, app_{app} {
    manager_.keep_pose_page(app_.page_to_keep());
    if (const std::optional<Duration> period = ServiceManager::watchdog_period()) {
      app_.watch(watchdog_.emplace(*period, host_now()));
    }
    manager_.tell(app_.summary());
    manager_.ready();
  }

  /// Until a signal ends it; false when the app has failed.
  bool run(const sigset_t& signals) {
    while (true) {
      const int signal = sigtimedwait(&signals, nullptr, &kLookPeriod);
      if (signal == SIGHUP) reload();
      if (signal == SIGINT || signal == SIGTERM) break;
      if (!look(host_now())) return false;
    }
    manager_.stopping();
    return true;
  }

 private:
  bool look(HostTime now) {
    const bool healthy = app_.supervise();
    if (watchdog_) guard(now);
    if (now - told_at_ >= kTellPeriod) {
      told_at_ = now;
      manager_.tell(app_.summary());
    }
    return healthy;
  }

  void guard(HostTime now) {
    if (watchdog_->look(now)) manager_.alive();
    const std::string stuck = watchdog_->stuck(now);
    if (!stuck.empty() && stuck != stuck_) app_.log(LogLevel::kError, "watchdog state=starving part=" + stuck);
    stuck_ = stuck;
  }

  void reload() {
    manager_.reloading();
    const Loaded<Config> wanted = load_config(launch_.config_path, launch_.overrides);
    for (std::size_t i = 0; i < std::min(wanted.faults.size(), kMaxFaultsTold); ++i) refuse(wanted.faults[i]);
    if (wanted.faults.empty()) take_over(wanted.value);
    manager_.ready();
  }

  void take_over(const Config& wanted) {
    const std::vector<std::string> fixed = app_.reload(wanted);
    for (const std::string& key : fixed) refuse(key + ": takes a restart to change");
    if (fixed.empty()) app_.log(LogLevel::kInfo, "config state=reloaded");
  }

  void refuse(const std::string& reason) {
    app_.log(LogLevel::kError, "config state=refused, continuing with what was: reason=\"" + reason + "\"");
  }

  const Launch& launch_;
  App& app_;
  ServiceManager manager_;
  std::optional<Watchdog> watchdog_;  // none: nobody waits for it
  std::string stuck_;
  HostTime told_at_;
};

}  // namespace

int run_daemon(const Launch& launch, const Config& config, const std::string& version) {
  const sigset_t signals = block_signals();
  HandedOver handed_over = ServiceManager::take_descriptors();
  Result<std::unique_ptr<App>> app =
      App::open(config, version, launch.record_folder, std::move(handed_over.pose_page));
  const Result<void> started = app ? (*app)->start(std::move(handed_over.listening)) : Error{app.reason()};
  if (!started) {
    std::cerr << "slamd: cannot start: " << started.reason() << '\n';
    return kExitFailure;
  }
  const bool healthy = Service{launch, **app}.run(signals);
  (*app)->stop();
  return healthy ? kExitDone : kExitFailure;
}

}  // namespace slamd
