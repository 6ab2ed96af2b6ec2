#pragma once
// A conversation with the daemon: version handshake, requests and their answers, notifications in order. What is behind the
// C interface; not what users include.

#include <chrono>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "tools/client/line_socket.hpp"

namespace slamd::client {

/// Why a function of the C interface fails: its code and its words.
class Failure : public std::runtime_error {
 public:
  Failure(int code, const std::string& text) : std::runtime_error{text}, code_{code} {}
  int code() const { return code_; }

 private:
  int code_;
};

/// One thread at a time. All methods throw Failure.
class Session {
 public:
  Session(const std::string& socket_path, std::chrono::milliseconds patience);

  struct Reply {
    nlohmann::json result;
    UniqueFd fd;
  };
  using OnProgress = std::function<void(const nlohmann::json& params)>;
  Reply call(const std::string& method, nlohmann::json params, const OnProgress& on_progress = {});

  /// The oldest notification not yet taken, of this method or of any when it is null; waits for one. Has "method" and "params".
  nlohmann::json next(const char* method = nullptr);

  const nlohmann::json& version() const { return version_; }

 private:
  nlohmann::json receive();
  void keep(nlohmann::json message);

  LineSocket socket_;
  std::chrono::milliseconds patience_;
  std::deque<nlohmann::json> notifications_;
  std::int64_t last_id_ = 0;
  nlohmann::json version_;
};

/// The pose that a notification tells; throws nlohmann::json::exception when it is none.
PoseSample pose_of(const nlohmann::json& params);

}  // namespace slamd::client
