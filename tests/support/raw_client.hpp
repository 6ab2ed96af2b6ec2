#pragma once
// A client of the daemon's socket that knows only bytes, lines and descriptors, so that tests can misbehave with it.

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/ring/unique_fd.hpp"

namespace slamd::test {

class RawClient {
 public:
  static constexpr int kPatience_ms = 60'000;  // bounds a broken test, not a slow machine

  explicit RawClient(const std::string& path) : socket_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    connected_ = ::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }

  bool connected() const { return connected_; }
  int fd() const { return socket_.get(); }

  /// Sends all; false when the daemon has hung up.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }
  bool request(int id, const std::string& method, nlohmann::json params = nlohmann::json::object()) {
    return send(nlohmann::json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", params}}.dump() + "\n");
  }

  /// The next line as JSON; nullopt when the daemon has hung up (or, in a broken test, said nothing for a minute).
  std::optional<nlohmann::json> receive() {
    while (received_.find('\n') == std::string::npos) {
      if (!receive_bytes()) return std::nullopt;
    }
    const std::size_t end = received_.find('\n');
    const std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    return nlohmann::json::parse(line);
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
  UniqueFd take_fd() {
    if (fds_.empty()) return {};
    UniqueFd fd = std::move(fds_.front());
    fds_.pop_front();
    return fd;
  }
  void shut_down_sending() { ::shutdown(socket_.get(), SHUT_WR); }

 private:
  bool receive_bytes() {
    pollfd state{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&state, 1, kPatience_ms) <= 0) return false;
    char bytes[8192];
    iovec part{.iov_base = bytes, .iov_len = sizeof bytes};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t count = ::recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
    eof_ = count <= 0;
    if (eof_) return false;
    if (const cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr) {
      int fd = -1;
      std::memcpy(&fd, CMSG_DATA(header), sizeof fd);
      fds_.emplace_back(fd);
    }
    received_.append(bytes, static_cast<std::size_t>(count));
    return true;
  }

  UniqueFd socket_;
  bool connected_ = false;
  bool eof_ = false;
  std::string received_;
  std::deque<UniqueFd> fds_;
};

}  // namespace slamd::test
