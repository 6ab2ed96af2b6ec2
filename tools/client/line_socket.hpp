#pragma once
// A Unix stream socket of lines and the descriptors that come with them. Knows no JSON and no protocol.

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/ring/unique_fd.hpp"

namespace slamd::client {

/// One thread.
class LineSocket {
 public:
  enum class Received { kLine, kTimeout, kHungUp, kTooLong };

  /// Connects; check connected(), whose failure left errno.
  explicit LineSocket(const std::string& path);

  bool connected() const { return static_cast<bool>(socket_); }
  int fd() const { return socket_.get(); }

  /// Sends all; false when the other side has hung up.
  bool send(std::string_view bytes);

  /// Waits for the next line (at most 16 MiB), which is then in line() without its line feed. The patience is that of one wait
  /// for bytes.
  Received receive(std::chrono::milliseconds patience);
  std::string_view line() const { return std::string_view{received_}.substr(0, line_size_); }

  /// The oldest descriptor not yet taken; an empty one when there is none.
  UniqueFd take_fd();

 private:
  std::optional<Received> receive_bytes(std::chrono::milliseconds patience);

  UniqueFd socket_;
  std::string received_;        // line() and its line feed, then what came after it
  std::size_t line_size_ = 0;
  std::size_t scanned_ = 0;     // bytes without a line feed
  bool has_line_ = false;
  std::deque<UniqueFd> fds_;
};

}  // namespace slamd::client
