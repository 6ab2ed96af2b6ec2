#pragma once
// A client of the daemon's socket that knows only lines and descriptors, so that tests can misbehave with it.

#include <sys/socket.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/ring/unique_fd.hpp"
#include "tools/client/line_socket.hpp"

namespace slamd::test {

class RawClient {
 public:
  static constexpr std::chrono::minutes kPatience{1};  // bounds a broken test, not a slow machine

  explicit RawClient(const std::string& path) : socket_{path} {}

  bool connected() const { return socket_.connected(); }
  int fd() const { return socket_.fd(); }

  /// Sends all; false when the daemon has hung up.
  bool send(std::string_view bytes) { return socket_.send(bytes); }
  bool request(int id, const std::string& method, nlohmann::json params = nlohmann::json::object()) {
    return send(nlohmann::json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}}.dump() + "\n");
  }

  /// The next line as JSON; nullopt when the daemon has hung up (or, in a broken test, said nothing for a minute).
  std::optional<nlohmann::json> receive() {
    const client::LineSocket::Received received = socket_.receive(kPatience);
    eof_ = received == client::LineSocket::Received::kHungUp;
    if (received != client::LineSocket::Received::kLine) return std::nullopt;
    return nlohmann::json::parse(socket_.line());
  }
  /// Skips lines until the answer to this request.
  nlohmann::json answer(int id) {
    while (std::optional<nlohmann::json> line = receive()) {
      if (line->contains("id") && line->at("id") == id) return *line;
    }
    return nullptr;
  }
  nlohmann::json call(int id, const std::string& method, nlohmann::json params = nlohmann::json::object()) {
    return request(id, method, std::move(params)) ? answer(id) : nlohmann::json{};
  }
  bool hung_up() {
    while (receive()) {
    }
    return eof_;
  }
  UniqueFd take_fd() { return socket_.take_fd(); }
  void shut_down_sending() { ::shutdown(socket_.fd(), SHUT_WR); }

 private:
  client::LineSocket socket_;
  bool eof_ = false;
};

}  // namespace slamd::test
