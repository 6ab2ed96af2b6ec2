#pragma once
// Finding the IMU board on the USB, in our firmware or in the boot loader, and moving it from one to the other. It does
// not write flash.

#include <optional>
#include <string>
#include <vector>

#include "drivers/io/usb_device.hpp"
#include "tools/imu-flash/picoboot_client.hpp"

namespace slamd::flash {

/// Every board in our firmware or in the RP2040's boot loader, in the order of ports.
std::vector<UsbListing> find_boards();

bool is_in_boot_loader(const UsbListing& board);

/// A firmware's version as its device descriptor has it: 0x0123 is "1.2.3".
std::string version_text(std::uint16_t release);

/// One line for people: port, state, version, serial number.
std::string describe(const UsbListing& board);

/// A board, or why none: nothing plugged in, several and no choice, no permission.
struct ChosenBoard {
  UsbListing board;
  std::string refusal;
  explicit operator bool() const { return refusal.empty(); }
};

/// wanted  serial number or port ("1-2.4"); empty takes the only one. In the boot loader all RP2040 say the same serial
///         number: there only the port tells boards apart.
ChosenBoard choose_board(const std::vector<UsbListing>& boards, const std::string& wanted);

/// Sends a board that runs our firmware into the boot loader and waits until it is there, at the same port. One that is
/// there already comes back at once.
ChosenBoard enter_boot_loader(const UsbListing& board);

/// Waits until our firmware is at the port; nothing when it does not come within the time.
std::optional<UsbListing> wait_for_firmware(const std::string& port, Duration timeout);

/// PICOBOOT over an opened device.
class UsbPicoboot final : public PicobootTransport {
 public:
  /// Opens and claims; a refusal is the text for people, empty when all went well.
  std::string open(const UsbListing& board);

  UsbTransfer send(std::span<const std::uint8_t> bytes, Duration timeout) override;
  UsbTransfer receive(std::span<std::uint8_t> bytes, Duration timeout) override;
  UsbTransfer reset_interface() override;
  UsbTransfer command_status(std::span<std::uint8_t> answer) override;

 private:
  UsbDevice device_;
  UsbInterface interface_;
};

/// What to do about a fault of opening a board, in words.
std::string opening_refusal(const UsbListing& board, UsbFault fault);

}  // namespace slamd::flash
