#include "tools/client/save_fd.hpp"

#include <fcntl.h>
#include <slamd/client.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "daemon/ring/unique_fd.hpp"
#include "tools/client/session.hpp"

namespace slamd::client {

void save_fd(int fd, const std::string& path, const std::function<void(std::size_t bytes)>& on_bytes) {
  constexpr mode_t kMode = 0644;
  const std::string temporary = path + ".part";
  UniqueFd file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode)};
  if (!file) throw Failure{SLAMD_SYSTEM, path + ": " + std::strerror(errno)};
  char bytes[65536];
  off_t offset = 0;
  ssize_t count = 0;
  while ((count = ::pread(fd, bytes, sizeof bytes, offset)) > 0) {
    const ssize_t written = ::write(file.get(), bytes, static_cast<std::size_t>(count));
    if (written <= 0) break;
    offset += written;
    on_bytes(static_cast<std::size_t>(offset));
  }
  const bool whole = count == 0 && ::fsync(file.get()) == 0 && ::rename(temporary.c_str(), path.c_str()) == 0;
  if (whole) return;
  const std::string reason = std::strerror(errno);
  ::unlink(temporary.c_str());
  throw Failure{SLAMD_SYSTEM, path + ": " + reason};
}

}  // namespace slamd::client
