#pragma once
// How the IMU board is known on USB, and the requests of its reset interface. Freestanding; descriptors are the
// firmware's, the boot loader's own protocol is tools/imu-flash's.

#include <cstdint>

namespace slamd {

/// Device descriptor of our firmware: a test id of pid.codes. bcdDevice is the firmware's version, a digit each (0x0123
/// = 1.2.3).
constexpr std::uint16_t kImuUsbVendor = 0x1209;
constexpr std::uint16_t kImuUsbProduct = 0x0001;
/// Its product string; other devices on the test id have another.
constexpr char kImuUsbProductName[] = "slamd IMU";

/// The reset interface: no endpoints, recognised by class, subclass and protocol.
constexpr std::uint8_t kImuResetClass = 0xFF;
constexpr std::uint8_t kImuResetSubclass = 0x00;
constexpr std::uint8_t kImuResetProtocol = 0x01;

/// Its requests: host to device, class request to that interface (bmRequestType 0x21), wValue 0, no data. The device
/// acknowledges and leaves the bus.
enum class ImuResetRequest : std::uint8_t {
  kBootLoader = 1,  // the ROM's boot loader
  kFlash = 2,       // starts the firmware again
};

/// Device descriptor of the RP2040's boot loader in ROM (data sheet 2.8.5.1).
constexpr std::uint16_t kBootLoaderUsbVendor = 0x2E8A;
constexpr std::uint16_t kBootLoaderUsbProduct = 0x0003;

}  // namespace slamd
