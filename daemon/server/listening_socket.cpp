#include "daemon/server/listening_socket.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>

namespace slamd {
namespace {

constexpr mode_t kMode = S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;

UniqueFd new_socket() { return UniqueFd{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)}; }

const sockaddr* generic(const sockaddr_un& address) { return reinterpret_cast<const sockaddr*>(&address); }

Result<UniqueFd> take_lock(const std::string& path) {
  UniqueFd lock{::open((path + ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR)};
  if (!lock) return Error{"the socket's folder does not exist or may not be written to"};
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) return Error{"another instance of slamd serves this socket"};
  return lock;
}

/// Makes room at the address; only ever removes a socket that nobody answers on.
Result<void> clear_place(const sockaddr_un& address) {
  struct stat status {};
  if (::lstat(address.sun_path, &status) != 0) {
    return errno == ENOENT ? Result<void>{} : Error{"the socket's path cannot be looked at"};
  }
  if (!S_ISSOCK(status.st_mode)) return Error{"the socket's path is taken by a file that is no socket"};
  const UniqueFd probe = new_socket();
  const bool answered = ::connect(probe.get(), generic(address), sizeof address) == 0 || errno == EAGAIN;
  if (answered) return Error{"another process serves this socket"};
  if (::unlink(address.sun_path) != 0) return Error{"a stale socket is there and cannot be removed"};
  return {};
}

}  // namespace

Result<ListeningSocket> ListeningSocket::open(const std::string& path, int backlog) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return Error{"the socket's path is empty or too long"};
  std::memcpy(address.sun_path, path.data(), path.size());

  Result<UniqueFd> lock = take_lock(path);
  if (!lock) return Error{lock.reason()};
  if (const Result<void> cleared = clear_place(address); !cleared) return Error{cleared.reason()};
  UniqueFd socket = new_socket();
  // The mode is set on the socket before bind() makes the file of it: at no moment may others connect.
  if (!socket || ::fchmod(socket.get(), kMode) != 0) return Error{"no socket"};
  if (::bind(socket.get(), generic(address), sizeof address) != 0) return Error{"the socket cannot be bound"};
  ListeningSocket listening{path, std::move(lock).value(), std::move(socket)};
  if (::chmod(path.c_str(), kMode) != 0) return Error{"the socket's mode cannot be set"};  // the umask took bits away
  if (::listen(listening.fd(), backlog) != 0) return Error{"the socket cannot be listened on"};
  return listening;
}

Result<ListeningSocket> ListeningSocket::adopt(UniqueFd socket) {
  const auto option = [&socket](int name) {
    int value = -1;
    socklen_t bytes = sizeof value;
    return ::getsockopt(socket.get(), SOL_SOCKET, name, &value, &bytes) == 0 ? value : -1;
  };
  const bool fits = option(SO_DOMAIN) == AF_UNIX && option(SO_TYPE) == SOCK_STREAM && option(SO_ACCEPTCONN) == 1;
  if (!fits) return Error{"the socket that was handed over is no listening Unix stream socket"};
  return ListeningSocket{"", {}, std::move(socket)};
}

ListeningSocket::~ListeningSocket() {
  if (socket_ && !path_.empty()) ::unlink(path_.c_str());
}

}  // namespace slamd
