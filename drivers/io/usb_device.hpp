#pragma once
// One USB device through libusb: found by identity and port, claimed by interface class, spoken to in bulk and control
// transfers. It knows no protocol and runs no thread of its own.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "estimator/types/time.hpp"

namespace slamd {

enum class UsbFault : std::uint8_t { kNone, kStall, kTimeout, kGone, kNoPermission, kBusy, kNoInterface, kOther };
const char* name(UsbFault fault);

struct UsbTransfer {
  UsbFault fault = UsbFault::kNone;
  std::size_t size = 0;  // bytes moved, also when a fault ended the transfer
  explicit operator bool() const { return fault == UsbFault::kNone; }
};

struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  friend bool operator==(const UsbId&, const UsbId&) = default;
};

/// One device on the bus as list() found it.
struct UsbListing {
  UsbId id;
  std::uint16_t release = 0;  // bcdDevice
  std::string port;           // where it is plugged in, as in sysfs: "1-2.4"; stays the same when it re-enumerates
  std::string node;           // "/dev/bus/usb/001/004"
  std::string serial;         // these two are empty when the device could not be opened
  std::string product_name;
  UsbFault fault = UsbFault::kNone;  // of opening it
};

struct UsbInterfaceClass {
  std::uint8_t class_code = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
};

/// A claimed interface with its first bulk endpoints; 0 = it has none.
struct UsbInterface {
  UsbFault fault = UsbFault::kNone;
  std::uint8_t number = 0;
  std::uint8_t bulk_in = 0;
  std::uint8_t bulk_out = 0;
  std::uint16_t packet_bytes = 0;  // largest packet of bulk_in
  explicit operator bool() const { return fault == UsbFault::kNone; }
};

/// bmRequestType, bRequest and wValue of a control transfer; wIndex is the number of the interface it is for.
struct UsbRequest {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
};

/// One thread. Every transfer costs libusb an allocation; nothing blocks beyond its timeout.
class UsbDevice {
 public:
  UsbDevice();
  UsbDevice(UsbDevice&&) noexcept;
  UsbDevice& operator=(UsbDevice&&) noexcept;
  ~UsbDevice();

  /// All devices with one of the ids, in the order of their ports. Looks at the bus anew each time, and opens each of
  /// them for a moment to read its strings.
  static std::vector<UsbListing> list(std::span<const UsbId> ids);

  /// Opens the device that has this id and port now; closes any other first.
  UsbFault open(const UsbListing& listing);
  void close();
  bool is_open() const;

  /// Claims the first interface of that class; the kernel's driver of it is detached until close().
  UsbInterface claim(const UsbInterfaceClass& which);

  /// Bulk; an empty span sends an empty packet. receive() ends with the first packet that is not full.
  UsbTransfer send(const UsbInterface& to, std::span<const std::uint8_t> bytes, Duration timeout);
  UsbTransfer receive(const UsbInterface& from, std::span<std::uint8_t> bytes, Duration timeout);
  /// Control transfers, with a second of time; the direction is that of request.type.
  UsbTransfer control(const UsbInterface& to, const UsbRequest& request, std::span<std::uint8_t> bytes = {});
  /// Ends the halt of both endpoints after a stall.
  void clear_halt(const UsbInterface& of);

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace slamd
