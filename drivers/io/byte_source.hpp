#pragma once
// What a stream of bytes from a device looks like to its driver, however it is plugged in: SerialSource for ttys,
// UsbSerialSource for USB without one. It understands no bytes.

#include <cstdint>
#include <span>

#include "estimator/types/time.hpp"

namespace slamd {

struct SourceStats {
  std::uint64_t bytes = 0;
  std::uint64_t openings = 0;  // that succeeded; the first included
  std::uint64_t failed_openings = 0;
  std::uint64_t losses = 0;  // the device went away while open
};

struct SourceRead {
  std::span<const std::uint8_t> bytes;  // valid until the next call; empty: timeout or device not there
  HostTime arrival;                     // right after the read
};

/// When a device that is not there is looked for again.
struct ReopenConfig {
  Duration shortest{100'000'000};  // wait after a failed opening; doubled with each failure
  Duration longest{2'000'000'000};
};

/// One thread. A device that is not there is a state, not an error.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// Waits at most `timeout` for bytes, so that the thread can stop; opens the device when it is due.
  virtual SourceRead read(Duration timeout) = 0;
  /// Sends all of `bytes`; false when the device is not open or does not take them within a second.
  virtual bool write(std::span<const std::uint8_t> bytes) = 0;
  virtual bool is_open() const = 0;
  virtual const SourceStats& stats() const = 0;
};

}  // namespace slamd
