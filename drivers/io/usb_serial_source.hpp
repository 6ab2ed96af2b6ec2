#pragma once
// Reads bytes of a USB CDC device straight from its bulk endpoint through libusb, without a tty, and follows unplug and
// replug by serial number. It runs no thread and understands no bytes.

#include <array>
#include <cstdint>
#include <string>

#include "drivers/io/byte_source.hpp"
#include "drivers/io/reopen_timer.hpp"
#include "drivers/io/usb_device.hpp"

namespace slamd {

struct UsbSerialSourceConfig {
  UsbId id;
  std::string serial;  // empty: the first device with the id
  ReopenConfig reopen{};
};

/// One thread. While it is open the kernel's tty of the device is gone; close() brings it back. Every read costs libusb
/// a small allocation and an uncontended lock, which SerialSource does not.
class UsbSerialSource final : public ByteSource {
 public:
  /// Opens nothing yet: a device that is not there is a state, not an error.
  explicit UsbSerialSource(UsbSerialSourceConfig config);

  /// One packet of the device at a time, so that its arrival is that packet's. The first open raises DTR.
  SourceRead read(Duration timeout) override;
  bool write(std::span<const std::uint8_t> bytes) override;
  bool is_open() const override { return device_.is_open(); }
  const SourceStats& stats() const override { return stats_; }

 private:
  static constexpr std::size_t kMaxPacket = 512;  // of high speed; the board's are 64

  bool open();
  bool claim();
  void lose();

  UsbSerialSourceConfig config_;
  UsbDevice device_;
  UsbInterface bulk_;
  ReopenTimer reopen_;
  SourceStats stats_;
  std::array<std::uint8_t, kMaxPacket> buffer_{};
};

}  // namespace slamd
