#pragma once
// The PICOBOOT protocol of the RP2040's boot loader (data sheet 2.8.5): commands, acknowledgements, status. It decides
// nothing about what is written where (flasher) and knows USB only as a transport.

#include <cstdint>
#include <span>
#include <string>

#include "drivers/io/usb_device.hpp"

namespace slamd::flash {

/// What PICOBOOT needs of USB; tests have their own.
class PicobootTransport {
 public:
  virtual ~PicobootTransport() = default;
  /// Bulk transfers; an empty span sends an empty packet.
  virtual UsbTransfer send(std::span<const std::uint8_t> bytes, Duration timeout) = 0;
  virtual UsbTransfer receive(std::span<std::uint8_t> bytes, Duration timeout) = 0;
  /// The interface's two control requests; reset also ends the halt of its endpoints.
  virtual UsbTransfer reset_interface() = 0;
  virtual UsbTransfer command_status(std::span<std::uint8_t> answer) = 0;
};

/// How a command ended.
struct PicobootOutcome {
  UsbFault fault = UsbFault::kNone;
  std::string text;  // what failed where and why, for people; empty without a fault
  explicit operator bool() const { return fault == UsbFault::kNone; }
};

/// One thread. Every command waits for the device, seconds at most.
class PicobootClient {
 public:
  static constexpr std::size_t kCommandBytes = 32;
  static constexpr std::size_t kStatusBytes = 16;

  explicit PicobootClient(PicobootTransport& transport) : transport_{transport} {}

  /// Ends whatever the boot loader was doing, then keeps its mass storage from writing as well.
  PicobootOutcome begin();
  /// Flash as a plain chip, not mapped: before erase, write and read.
  PicobootOutcome exit_xip();
  /// address, size: multiples of a sector.
  PicobootOutcome erase(std::uint32_t address, std::uint32_t size);
  /// address, size: multiples of a page. Writing does not erase.
  PicobootOutcome write(std::uint32_t address, std::span<const std::uint8_t> bytes);
  PicobootOutcome read(std::uint32_t address, std::span<std::uint8_t> bytes);
  /// Starts what is in the flash, or the boot loader again when nothing valid is there.
  PicobootOutcome reboot(std::uint32_t delay_ms);

 private:
  struct Command;

  PicobootOutcome run(const Command& command, std::span<const std::uint8_t> out, std::span<std::uint8_t> in);
  PicobootOutcome fail(const Command& command, const UsbTransfer& transfer);

  PicobootTransport& transport_;
  std::uint32_t token_ = 0;
};

}  // namespace slamd::flash
