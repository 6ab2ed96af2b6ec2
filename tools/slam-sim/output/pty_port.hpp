#pragma once
// A pseudo terminal that plays a USB serial device: a symlink to its slave side is the "port".

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "tools/slam-sim/output/file_descriptor.hpp"

namespace slamd::sim {

class PtyPort {
 public:
  /// Replaces an existing symlink at `link`, nothing else. Throws std::runtime_error with path and reason.
  explicit PtyPort(const std::filesystem::path& link);
  /// Removes the symlink.
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  /// Never blocks. As with a device whose host does not read, old bytes are dropped when 2 KiB lie unread.
  /// False when bytes were dropped.
  bool write(std::span<const std::uint8_t> bytes);
  /// What the host has sent since the last call, 256 bytes at most. Never blocks; valid until the next call.
  std::span<const std::uint8_t> read();

 private:
  FileDescriptor master_;
  FileDescriptor slave_;  // held open, so that readers may come and go
  std::filesystem::path link_;
  std::array<std::uint8_t, 256> received_{};
};

}  // namespace slamd::sim
