#pragma once
// Looks at the stream of a board just flashed: firmware version and measured rate. It changes nothing on the board.

#include <string>

#include "drivers/io/usb_device.hpp"

namespace slamd::flash {

struct StreamReport {
  std::string text;     // for people: version, serial number, rate
  std::string failure;  // empty: the board sends samples
  explicit operator bool() const { return failure.empty(); }
};

/// Reads the stream for `span` from its first sample on; waits at most `patience` for that one.
StreamReport check_stream(const UsbListing& board, Duration span, Duration patience);

}  // namespace slamd::flash
