#pragma once
// Reads bytes of a serial port (tty, USB CDC or pty) by its path and follows unplug and replug. It runs no thread and
// understands no bytes.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/io/byte_source.hpp"
#include "drivers/io/reopen_timer.hpp"

namespace slamd {

struct SerialSourceConfig {
  std::string path;             // stable: /dev/serial/by-id/...; a symlink is followed anew at every opening
  std::uint32_t baud = 115200;  // no meaning for USB CDC and ptys
  bool raise_dtr = true;  // when it is opened; on some devices the line switches a motor off
  ReopenConfig reopen{};
};

/// One thread. read() allocates only when it opens the port; it returns within its timeout, so that the thread can
/// stop.
class SerialSource final : public ByteSource {
 public:
  static constexpr std::size_t kMaxRead = 4096;

  /// Opens nothing yet: a port that is not there is a state, not an error.
  explicit SerialSource(SerialSourceConfig config);
  SerialSource(SerialSource&&) noexcept;
  SerialSource& operator=(SerialSource&&) noexcept;
  ~SerialSource() override;

  /// Waits at most `timeout` for bytes; opens the port when it is due. Raw mode: all bytes pass unchanged, 8N1, no flow
  /// control.
  SourceRead read(Duration timeout) override;
  bool write(std::span<const std::uint8_t> bytes) override;

  bool is_open() const override;
  const SourceStats& stats() const override { return stats_; }

 private:
  struct Port;

  bool open();
  void lose();

  SerialSourceConfig config_;
  std::unique_ptr<Port> port_;
  ReopenTimer reopen_;
  SourceStats stats_;
};

}  // namespace slamd
