#pragma once
// The descriptors that the IMU board shows to a USB host, as bytes. What is answered when is UsbControl.

#include <array>
#include <cstdint>
#include <span>

namespace slamd {

constexpr std::uint16_t kUsbPacketBytes = 64;

constexpr std::uint8_t kControlInterface = 0, kDataInterface = 1, kResetInterface = 2;
constexpr std::uint8_t kNotifyEndpoint = 0x81, kOutEndpoint = 0x02, kInEndpoint = 0x82;
constexpr std::uint8_t kUsbStringCount = 6;

using UniqueId = std::array<std::uint8_t, 8>;

std::span<const std::uint8_t> device_descriptor();
std::span<const std::uint8_t> configuration_descriptor();

/// A string descriptor with its header.
struct StringDescriptor {
  std::array<std::uint8_t, 64> bytes{};
  std::uint8_t size = 0;

  std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
};

/// index 0 the languages, 1 manufacturer, 2 product, 3 serial number (the unique id in hex), 4 stream, 5 reset
/// interface; any other gives an empty one.
StringDescriptor string_descriptor(std::uint8_t index, const UniqueId& id);

}  // namespace slamd
