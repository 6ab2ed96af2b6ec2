#pragma once
// What passes between slamd and the service manager that started it (systemd): descriptors, notifications, the watchdog's
// period. Without a service manager nothing is handed over and every notification goes nowhere.

#include <optional>
#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// Descriptors from the service manager; those that it did not pass are none.
struct HandedOver {
  UniqueFd listening;  // the clients' socket, already listened on
  UniqueFd pose_page;  // the page of the daemon before us
};

/// One thread calls all methods.
class ServiceManager {
 public:
  /// What was handed over to this process. Takes ownership; call once, before any thread starts. Descriptors of unknown
  /// names are closed.
  static HandedOver take_descriptors();

  /// The period within which alive() must be called; nullopt when nobody waits for it.
  static std::optional<Duration> watchdog_period();

  void ready();
  void alive();
  void reloading();  // ready() ends it
  void stopping();

  /// One line for people; sent when it differs from the last one.
  void tell(const std::string& status);

  /// Keeps a duplicate of the page for the next daemon, in place of what was kept before.
  void keep_pose_page(int memfd);

 private:
  std::string told_;
};

}  // namespace slamd
