#pragma once
// The Unix socket that clients connect to: its place in the file system and who may own it. Accepts nobody itself.

#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// A listening stream socket at `path`, mode 0660, and the lock beside it (`path`.lock) that keeps a second instance
/// out for as long as the process lives. The destructor removes the socket.
class ListeningSocket {
 public:
  /// A stale socket (nobody answers) is replaced; one that answers, a held lock or a file that is no socket is an error.
  static Result<ListeningSocket> open(const std::string& path, int backlog);

  ListeningSocket(ListeningSocket&&) noexcept = default;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  ~ListeningSocket();

  int fd() const { return socket_.get(); }

 private:
  ListeningSocket(std::string path, UniqueFd lock, UniqueFd socket)
      : path_{std::move(path)}, lock_{std::move(lock)}, socket_{std::move(socket)} {}

  std::string path_;
  UniqueFd lock_;
  UniqueFd socket_;
};

}  // namespace slamd
