#pragma once
// A C++ client of slamd's socket: connect, call, subscribe, take the map and the pose page. Blocking, one connection, one
// thread at a time. Includes nothing of the daemon but daemon/server/protocol.

#include <chrono>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/server/protocol/protocol.hpp"

namespace slamd::client {

/// Why a call has no result. code: one of protocol::error where the daemon answered so; kNoConnection or kTimeout else.
class ClientError : public std::runtime_error {
 public:
  static constexpr int kNoConnection = 1;  // nobody listens, no permission, or the daemon has hung up
  static constexpr int kTimeout = 2;
  static constexpr int kProtocol = 3;      // what came is not what the protocol says

  ClientError(int code, const std::string& text) : std::runtime_error{text}, code_{code} {}
  int code() const { return code_; }

 private:
  int code_;
};

struct Notification {
  std::string topic;  // "pose", "status", "progress", "lost"
  nlohmann::json params;
};

struct Answer {
  nlohmann::json result;
  UniqueFd fd;  // where the result says "fd": true
};

class Connection {
 public:
  using Patience = std::chrono::milliseconds;

  /// Connects and agrees on the protocol's version. Throws ClientError.
  explicit Connection(const std::string& socket_path = protocol::kDefaultSocketPath,
                      Patience patience = std::chrono::seconds{10});

  /// One request and its answer. Notifications that come meanwhile wait for next(), except that `on_progress`, when
  /// given, is told of the request's progress (params as the protocol documents). Throws ClientError.
  using OnProgress = std::function<void(const nlohmann::json& params)>;
  Answer call(const std::string& method, nlohmann::json params = nlohmann::json::object(),
              const OnProgress& on_progress = {});

  /// topic "pose" or "status"; then next() gives its notifications. The newest 10,000 that nobody took are kept.
  void subscribe(const std::string& topic, double rate_hz);
  void unsubscribe(const std::string& topic);

  /// The oldest notification not yet taken; waits for one up to the patience. Throws ClientError.
  Notification next();

  /// Read-only shared memory with the newest pose; stays readable after the connection has gone.
  PosePageReader pose_page();

  /// The daemon's answer to "version".
  const nlohmann::json& version() const { return version_; }

 private:
  void connect(const std::string& socket_path);
  void send(const std::string& line);
  nlohmann::json receive_line();
  void receive_bytes();
  void keep(const nlohmann::json& message);
  UniqueFd take_fd();

  UniqueFd socket_;
  Patience patience_;
  nlohmann::json version_;
  std::string received_;
  std::size_t scanned_ = 0;
  std::deque<UniqueFd> fds_;
  std::deque<Notification> notifications_;
  std::int64_t last_id_ = 0;
};

/// Copies all of a descriptor's content to `path`, by way of a temporary file beside it that is then renamed.
/// on_bytes, when given, is told how much is written. Throws ClientError.
void save_fd(int fd, const std::string& path, const std::function<void(std::size_t bytes)>& on_bytes = {});

}  // namespace slamd::client
