#include "tools/client/client.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace slamd::client {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestLine = 16 * 1024 * 1024;
constexpr std::size_t kMostNotifications = 10'000;

std::string errno_text() { return std::strerror(errno); }

}  // namespace

Connection::Connection(const std::string& socket_path, Patience patience) : patience_{patience} {
  connect(socket_path);
  version_ = call(protocol::method::kVersion, {{"protocol", protocol::kVersion}}).result;
}

void Connection::connect(const std::string& socket_path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_path.size() >= sizeof address.sun_path) {
    throw ClientError{ClientError::kNoConnection, socket_path + ": too long for a socket's path"};
  }
  socket_path.copy(address.sun_path, sizeof address.sun_path - 1);
  socket_ = UniqueFd{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  if (::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw ClientError{ClientError::kNoConnection, socket_path + ": " + errno_text()};
  }
}

Answer Connection::call(const std::string& method, json params, const OnProgress& on_progress) {
  const std::int64_t id = ++last_id_;
  send(json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}}.dump() + '\n');
  while (true) {
    json message = receive_line();
    if (message.contains("method")) {
      const bool is_progress = message["method"] == protocol::notification::kProgress;
      is_progress && on_progress ? on_progress(message["params"]) : keep(message);
      continue;
    }
    if (const auto error = message.find("error"); error != message.end()) {
      throw ClientError{error->value("code", ClientError::kProtocol), error->value("message", "error")};
    }
    if (message.value("id", json{}) != id || !message.contains("result")) continue;  // of a call given up before
    Answer answer{std::move(message["result"]), {}};
    const bool has_fd = answer.result.is_object() && answer.result.value(protocol::kFdField, false);
    if (has_fd) answer.fd = take_fd();
    return answer;
  }
}

void Connection::subscribe(const std::string& topic, double rate_hz) {
  call(protocol::method::kSubscribe, {{"topic", topic}, {"rate_hz", rate_hz}});
}

void Connection::unsubscribe(const std::string& topic) { call(protocol::method::kUnsubscribe, {{"topic", topic}}); }

Notification Connection::next() {
  while (notifications_.empty()) keep(receive_line());
  Notification notification = std::move(notifications_.front());
  notifications_.pop_front();
  return notification;
}

PosePageReader Connection::pose_page() {
  const Answer answer = call(protocol::method::kGetPosePage);
  std::optional<PosePageReader> page = PosePageReader::map(answer.fd.get());
  if (!page) throw ClientError{ClientError::kProtocol, "the pose page is of a version that this client does not know"};
  return *std::move(page);
}

void Connection::keep(const json& message) {
  if (!message.contains("method") || !message["method"].is_string()) return;
  if (notifications_.size() == kMostNotifications) notifications_.pop_front();
  notifications_.push_back({message["method"].get<std::string>(), message.value("params", json::object())});
}

UniqueFd Connection::take_fd() {
  if (fds_.empty()) throw ClientError{ClientError::kProtocol, "the answer came without its file descriptor"};
  UniqueFd fd = std::move(fds_.front());
  fds_.pop_front();
  return fd;
}

void Connection::send(const std::string& line) {
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t count = ::send(socket_.get(), line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw ClientError{ClientError::kNoConnection, "the daemon has hung up: " + errno_text()};
    sent += static_cast<std::size_t>(count);
  }
}

json Connection::receive_line() {
  std::size_t end = std::string::npos;
  while ((end = received_.find('\n', scanned_)) == std::string::npos) {
    scanned_ = received_.size();
    if (scanned_ > kLongestLine) throw ClientError{ClientError::kProtocol, "endless line from the daemon"};
    receive_bytes();
  }
  json message = json::parse(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
  received_.erase(0, end + 1);
  scanned_ = 0;
  if (!message.is_object()) throw ClientError{ClientError::kProtocol, "the daemon sent what is not JSON-RPC"};
  return message;
}

void Connection::receive_bytes() {
  pollfd state{.fd = socket_.get(), .events = POLLIN, .revents = 0};
  const int ready = ::poll(&state, 1, static_cast<int>(patience_.count()));
  if (ready < 0 && errno == EINTR) return;
  if (ready <= 0) throw ClientError{ClientError::kTimeout, "no answer from the daemon in time"};
  char bytes[16384];
  iovec part{.iov_base = bytes, .iov_len = sizeof bytes};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  const ssize_t count = ::recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
  if (count < 0 && errno == EINTR) return;
  if (count <= 0) throw ClientError{ClientError::kNoConnection, "the daemon has hung up"};
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_RIGHTS) {
    int fd = -1;
    std::memcpy(&fd, CMSG_DATA(header), sizeof fd);
    fds_.emplace_back(fd);
  }
  received_.append(bytes, static_cast<std::size_t>(count));
}

void save_fd(int fd, const std::string& path, const std::function<void(std::size_t bytes)>& on_bytes) {
  const auto fail = [&path](const std::string& text) {
    throw ClientError{protocol::error::kWriteFailed, path + ": " + text};
  };
  constexpr mode_t kMode = 0644;
  const std::string temporary = path + ".part";
  UniqueFd file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode)};
  if (!file) fail(errno_text());
  char bytes[65536];
  off_t offset = 0;
  ssize_t count = 0;
  while ((count = ::pread(fd, bytes, sizeof bytes, offset)) > 0) {
    const ssize_t written = ::write(file.get(), bytes, static_cast<std::size_t>(count));
    if (written <= 0) break;
    offset += written;
    if (on_bytes) on_bytes(static_cast<std::size_t>(offset));
  }
  const bool whole = count == 0 && ::fsync(file.get()) == 0 && ::rename(temporary.c_str(), path.c_str()) == 0;
  if (whole) return;
  const std::string reason = errno_text();
  ::unlink(temporary.c_str());
  fail(reason);
}

}  // namespace slamd::client
