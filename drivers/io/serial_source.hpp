#pragma once
// Reads bytes of a serial port (tty, USB CDC or pty) by its path and follows unplug and replug. It runs no thread and
// understands no bytes.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "estimator/types/time.hpp"

namespace slamd {

struct SerialSourceConfig {
  std::string path;                  // stable: /dev/serial/by-id/...; a symlink is followed anew at every opening
  std::uint32_t baud = 115200;       // no meaning for USB CDC and ptys
  Duration reopen_min{100'000'000};  // wait after a failed opening; doubled with each failure
  Duration reopen_max{2'000'000'000};
};

struct SerialStats {
  std::uint64_t bytes = 0;
  std::uint64_t openings = 0;  // that succeeded; the first included
  std::uint64_t failed_openings = 0;
  std::uint64_t losses = 0;  // the port went away while open
};

struct SerialRead {
  std::span<const std::uint8_t> bytes;  // valid until the next call; empty: timeout or port not there
  HostTime arrival;                     // right after the read
};

/// One thread. read() allocates only when it opens the port; it returns within its timeout, so that the thread can
/// stop.
class SerialSource {
 public:
  static constexpr std::size_t kMaxRead = 4096;

  /// Opens nothing yet: a port that is not there is a state, not an error.
  explicit SerialSource(SerialSourceConfig config);
  SerialSource(SerialSource&&) noexcept;
  SerialSource& operator=(SerialSource&&) noexcept;
  ~SerialSource();

  /// Waits at most `timeout` for bytes; opens the port when it is due. Raw mode: all bytes pass unchanged, 8N1, no flow
  /// control.
  SerialRead read(Duration timeout);

  bool is_open() const;
  const SerialStats& stats() const { return stats_; }

 private:
  struct Port;

  bool open();
  void lose();
  void wait_to_reopen(HostTime deadline);

  SerialSourceConfig config_;
  std::unique_ptr<Port> port_;
  HostTime next_opening_{};
  Duration backoff_{};
  SerialStats stats_;
};

}  // namespace slamd
