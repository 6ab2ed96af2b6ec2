#pragma once
// Bytes from the host to commands. What they do is Device's business.

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/protocol/command.hpp"

namespace slamd {

class CommandReader {
 public:
  /// Takes one byte; returns the command that it completes. After any garbage the first command behind a delimiter is
  /// found.
  std::optional<Command> take(std::uint8_t byte);

  /// Packets that were no command.
  std::uint32_t rejected() const { return rejected_; }

 private:
  std::array<std::uint8_t, kMaxPacketBytes> packet_{};
  std::size_t size_ = 0;  // since the last delimiter, also bytes that did not fit
  std::uint32_t rejected_ = 0;
};

}  // namespace slamd
