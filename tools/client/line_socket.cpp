#include "tools/client/line_socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace slamd::client {
namespace {

constexpr std::size_t kLongestLine = 16 * 1024 * 1024;
constexpr std::size_t kMostFds = 4;  // in one receive; the daemon sends one a line

}  // namespace

LineSocket::LineSocket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return;
  }
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  UniqueFd fd{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) socket_ = std::move(fd);
}

bool LineSocket::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

LineSocket::Received LineSocket::receive(std::chrono::milliseconds patience) {
  if (has_line_) received_.erase(0, line_size_ + 1);
  has_line_ = false;
  line_size_ = scanned_ = 0;
  std::size_t end = std::string::npos;
  while ((end = received_.find('\n', scanned_)) == std::string::npos) {
    scanned_ = received_.size();
    if (scanned_ > kLongestLine) return Received::kTooLong;
    if (const std::optional<Received> failure = receive_bytes(patience)) return *failure;
  }
  line_size_ = end;
  has_line_ = true;
  return Received::kLine;
}

UniqueFd LineSocket::take_fd() {
  if (fds_.empty()) return {};
  UniqueFd fd = std::move(fds_.front());
  fds_.pop_front();
  return fd;
}

std::optional<LineSocket::Received> LineSocket::receive_bytes(std::chrono::milliseconds patience) {
  pollfd state{.fd = socket_.get(), .events = POLLIN, .revents = 0};
  const int ready = ::poll(&state, 1, static_cast<int>(patience.count()));
  if (ready < 0 && errno == EINTR) return std::nullopt;
  if (ready <= 0) return Received::kTimeout;
  std::array<char, 16384> bytes;
  iovec part{.iov_base = bytes.data(), .iov_len = bytes.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostFds * sizeof(int))> control;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t count = ::recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
  if (count < 0 && errno == EINTR) return std::nullopt;
  if (count <= 0) return Received::kHungUp;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_RIGHTS) {
    std::array<int, kMostFds> came;
    const std::size_t size = header->cmsg_len - CMSG_LEN(0);
    std::memcpy(came.data(), CMSG_DATA(header), size);
    for (std::size_t i = 0; i < size / sizeof(int); ++i) fds_.emplace_back(came[i]);
  }
  received_.append(bytes.data(), static_cast<std::size_t>(count));
  return std::nullopt;
}

}  // namespace slamd::client
