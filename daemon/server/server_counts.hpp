#pragma once
// What the server has counted about its clients. Plain numbers of the server's thread.

#include <cstdint>
#include <nlohmann/json.hpp>

namespace slamd {

struct ServerCounts {
  std::uint64_t clients = 0;             // connected now
  std::uint64_t accepted = 0;
  std::uint64_t refused_clients = 0;     // max_clients was reached
  std::uint64_t requests = 0;
  std::uint64_t bad_requests = 0;        // lines that were no request
  std::uint64_t failed_requests = 0;     // answered with an error
  std::uint64_t too_long = 0;            // lines; their senders were dropped
  std::uint64_t throttled = 0;           // times that a client had to wait for its rate
  std::uint64_t notifications = 0;       // sent
  std::uint64_t lost_notifications = 0;  // for slow clients
  std::uint64_t stalled_clients = 0;     // dropped because they took nothing
  std::uint64_t refused_jobs = 0;        // max_jobs was reached
  std::uint64_t refused_control = 0;     // methods that write, called by clients without the right
  std::uint64_t internal_errors = 0;

  nlohmann::json to_json() const {
    return {{"clients", clients},
            {"accepted", accepted},
            {"refused_clients", refused_clients},
            {"requests", requests},
            {"bad_requests", bad_requests},
            {"failed_requests", failed_requests},
            {"too_long", too_long},
            {"throttled", throttled},
            {"notifications", notifications},
            {"lost_notifications", lost_notifications},
            {"stalled_clients", stalled_clients},
            {"refused_jobs", refused_jobs},
            {"refused_control", refused_control},
            {"internal_errors", internal_errors}};
  }
};

}  // namespace slamd
