#pragma once
// The Unix socket that clients connect to: its place in the file system and who may own it. Accepts nobody itself.

#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// A listening stream socket: one of our own at `path`, mode 0660, with the lock beside it (`path`.lock) that keeps a
/// second instance out for as long as the process lives, and removed by the destructor; or one that was handed to us,
/// whose place in the file system is its owner's matter.
class ListeningSocket {
 public:
  /// A stale socket (nobody answers) is replaced; one that answers, a held lock or a file that is no socket is an error.
  static Result<ListeningSocket> open(const std::string& path, int backlog);

  /// What the service manager listens on for us; an error when that is no listening Unix stream socket.
  static Result<ListeningSocket> adopt(UniqueFd socket);

  ListeningSocket(ListeningSocket&&) noexcept = default;
  ListeningSocket& operator=(ListeningSocket&&) = delete;
  ~ListeningSocket();

  int fd() const { return socket_.get(); }

 private:
  ListeningSocket(std::string path, UniqueFd lock, UniqueFd socket)
      : path_{std::move(path)}, lock_{std::move(lock)}, socket_{std::move(socket)} {}

  std::string path_;  // empty: adopted
  UniqueFd lock_;
  UniqueFd socket_;
};

}  // namespace slamd
