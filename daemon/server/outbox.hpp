#pragma once
// What waits to be sent to one client: lines, some with a file descriptor. Never blocks and keeps no timer; the session
// decides what is let in.

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

#include "daemon/ring/unique_fd.hpp"

namespace slamd {

class Outbox {
 public:
  using Line = std::shared_ptr<const std::string>;  // shared by all subscribers of a topic

  void push(Line line, UniqueFd fd = {});

  enum class Flush { kDone, kBlocked, kBroken };
  /// Sends as much as the socket takes. kBroken: the peer has gone.
  Flush flush(int socket);

  std::size_t bytes() const { return bytes_; }
  bool empty() const { return messages_.empty(); }
  std::size_t total_sent() const { return total_sent_; }
  /// Descriptors that wait here or, as far as is known, in the peer's socket: none as soon as the peer has taken all.
  std::size_t untaken_fds(int socket);

 private:
  struct Message {
    Line line;
    UniqueFd fd;  // goes with the first byte
    std::size_t sent = 0;
  };

  std::deque<Message> messages_;
  std::size_t bytes_ = 0;  // not yet sent
  std::size_t total_sent_ = 0;
  std::size_t untaken_fds_ = 0;
};

}  // namespace slamd
