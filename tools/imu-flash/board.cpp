#include "tools/imu-flash/board.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

#include "firmware/protocol/usb_identity.hpp"

namespace slamd::flash {
namespace {

constexpr UsbId kFirmware{kImuUsbVendor, kImuUsbProduct};
constexpr UsbId kBootLoader{kBootLoaderUsbVendor, kBootLoaderUsbProduct};
constexpr UsbInterfaceClass kReset{kImuResetClass, kImuResetSubclass, kImuResetProtocol};
constexpr UsbInterfaceClass kPicoboot{0xFF, 0x00, 0x00};
constexpr std::uint8_t kClassToInterface = 0x21;
constexpr std::uint8_t kVendorToInterface = 0x41;
constexpr std::uint8_t kVendorFromInterface = 0xC1;
constexpr std::uint8_t kInterfaceReset = 0x41;
constexpr std::uint8_t kCommandStatus = 0x42;
constexpr Duration kReenumeration = std::chrono::seconds{10};
constexpr Duration kLookPeriod = std::chrono::milliseconds{100};

std::optional<UsbListing> wait_for(const UsbId& id, const std::string& port, Duration timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::optional<UsbListing> refused;  // there, but not to be opened: udev sets the permission a moment later
  do {
    for (const UsbListing& found : UsbDevice::list(std::array{id})) {
      if (found.port != port) continue;
      if (found.fault == UsbFault::kNone) return found;
      refused = found;
    }
    std::this_thread::sleep_for(kLookPeriod);
  } while (std::chrono::steady_clock::now() < deadline);
  return refused;
}

std::string list_of(const std::vector<UsbListing>& boards) {
  std::string text;
  for (const UsbListing& board : boards) text += "\n  " + describe(board);
  return text;
}

}  // namespace

std::vector<UsbListing> find_boards() {
  return UsbDevice::list(std::array{kFirmware, kBootLoader});
}

bool is_in_boot_loader(const UsbListing& board) {
  return board.id == kBootLoader;
}

std::string version_text(std::uint16_t release) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%x.%x.%x", release >> 8U, release >> 4U & 0xFU, release & 0xFU);
  return text.data();
}

std::string describe(const UsbListing& board) {
  std::array<char, 256> text{};
  const std::string serial = board.fault != UsbFault::kNone ? name(board.fault) : board.serial;
  if (is_in_boot_loader(board)) {
    std::snprintf(text.data(), text.size(), "port %-8s RP2040 boot loader  serial %s", board.port.c_str(),
                  serial.c_str());
  } else {
    std::snprintf(text.data(), text.size(), "port %-8s slamd IMU %s  serial %s", board.port.c_str(),
                  version_text(board.release).c_str(), serial.c_str());
  }
  return text.data();
}

ChosenBoard choose_board(const std::vector<UsbListing>& boards, const std::string& wanted) {
  if (boards.empty()) {
    return {{},
            "no board found: neither our firmware (1209:0001) nor the boot loader (2e8a:0003) is on the USB.\n"
            "Is the cable one that carries data? See imu-flash --rescue."};
  }
  std::vector<UsbListing> matching;
  for (const UsbListing& board : boards) {
    if (wanted.empty() || board.serial == wanted || board.port == wanted) matching.push_back(board);
  }
  if (matching.empty())
    return {{}, "no board has the serial number or port '" + wanted + "'; there are:" + list_of(boards)};
  if (matching.size() > 1) {
    return {{}, "several boards; choose one with --serial SERIAL (or --serial PORT):" + list_of(matching)};
  }
  if (matching.front().fault != UsbFault::kNone) return {{}, opening_refusal(matching.front(), matching.front().fault)};
  return {matching.front(), {}};
}

ChosenBoard enter_boot_loader(const UsbListing& board) {
  if (is_in_boot_loader(board)) return {board, {}};
  UsbDevice device;
  const UsbFault opened = device.open(board);
  if (opened != UsbFault::kNone) return {{}, opening_refusal(board, opened)};
  const UsbInterface reset = device.claim(kReset);
  if (!reset)
    return {{}, "the board's reset interface: " + std::string{name(reset.fault)} + ". See imu-flash --rescue."};
  const auto request = static_cast<std::uint8_t>(ImuResetRequest::kBootLoader);
  const UsbTransfer asked = device.control(reset, {kClassToInterface, request, 0});
  if (asked.fault == UsbFault::kStall) {
    return {{}, "the board refuses to go to its boot loader (stall). See imu-flash --rescue."};
  }
  device.close();
  // Any other fault may be that of a board that left before its acknowledgement: what counts is whether it comes back.
  const std::optional<UsbListing> found = wait_for(kBootLoader, board.port, kReenumeration);
  if (!found) return {{}, "the board did not come back as boot loader within 10 s. See imu-flash --rescue."};
  if (found->fault != UsbFault::kNone) return {{}, opening_refusal(*found, found->fault)};
  return {*found, {}};
}

std::optional<UsbListing> wait_for_firmware(const std::string& port, Duration timeout) {
  return wait_for(kFirmware, port, timeout);
}

std::string UsbPicoboot::open(const UsbListing& board) {
  const UsbFault opened = device_.open(board);
  if (opened != UsbFault::kNone) return opening_refusal(board, opened);
  interface_ = device_.claim(kPicoboot);
  if (!interface_) return opening_refusal(board, interface_.fault);
  return {};
}

UsbTransfer UsbPicoboot::send(std::span<const std::uint8_t> bytes, Duration timeout) {
  return device_.send(interface_, bytes, timeout);
}

UsbTransfer UsbPicoboot::receive(std::span<std::uint8_t> bytes, Duration timeout) {
  return device_.receive(interface_, bytes, timeout);
}

/// The device ends its halts with the request; the host's side of them (data toggles) ends with clear_halt().
UsbTransfer UsbPicoboot::reset_interface() {
  device_.clear_halt(interface_);
  return device_.control(interface_, {kVendorToInterface, kInterfaceReset, 0});
}

UsbTransfer UsbPicoboot::command_status(std::span<std::uint8_t> answer) {
  return device_.control(interface_, {kVendorFromInterface, kCommandStatus, 0}, answer);
}

std::string opening_refusal(const UsbListing& board, UsbFault fault) {
  std::string text = "cannot open the board at port " + board.port + ": " + name(fault);
  if (fault == UsbFault::kNoPermission) {
    text += " for " + board.node +
            ".\nThe udev rule 60-slamd.rules gives it to the group plugdev and to the user at the seat:\n"
            "  sudo install -m 644 systemd/60-slamd.rules /etc/udev/rules.d/60-slamd.rules\n"
            "  sudo udevadm control --reload && sudo udevadm trigger\n"
            "and plug the board in again. Or run imu-flash as root.";
  } else if (fault == UsbFault::kBusy) {
    text += ".\nIs slamd running with imu.source: usb, or another imu-flash?";
  }
  return text;
}

}  // namespace slamd::flash
