#include "firmware/core/usb_descriptors.hpp"

#include "firmware/core/version.hpp"
#include "firmware/protocol/usb_identity.hpp"

namespace slamd {
namespace {

constexpr std::uint8_t low(std::uint16_t value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}
constexpr std::uint8_t high(std::uint16_t value) {
  return static_cast<std::uint8_t>(value >> 8U);
}

constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kString = 3, kInterface = 4, kEndpoint = 5, kAssociation = 11,
                       kClassSpecific = 0x24;
constexpr std::uint8_t kBulk = 2, kInterrupt = 3;

// clang-format off: a descriptor a line
constexpr std::array<std::uint8_t, 18> kDeviceDescriptor{18,
                                                         kDevice,
                                                         0x00,
                                                         0x02,  // USB 2.0
                                                         0xEF,
                                                         0x02,
                                                         0x01,  // interfaces are grouped by association descriptors
                                                         64,    // packet of endpoint 0
                                                         low(kImuUsbVendor),
                                                         high(kImuUsbVendor),
                                                         low(kImuUsbProduct),
                                                         high(kImuUsbProduct),
                                                         kFirmwareVersion[1] << 4 | kFirmwareVersion[2],
                                                         kFirmwareVersion[0],
                                                         1,
                                                         2,
                                                         3,  // strings: manufacturer, product, serial number
                                                         1};

constexpr std::array<std::uint8_t, 84> kConfigurationDescriptor{
    9, kConfiguration, 84, 0, 3, 1, 0, 0x80, 50,  // three interfaces, powered by the bus, 100 mA
    8, kAssociation, kControlInterface, 2, 0x02, 0x02, 0x00, 4,
    // Serial port (CDC 1.2, abstract control model): control interface with its functional descriptors, data interface
    9, kInterface, kControlInterface, 0, 1, 0x02, 0x02, 0x00, 4, 5, kClassSpecific, 0x00, 0x20, 0x01,  // header
    5, kClassSpecific, 0x01, 0x00, kDataInterface,  // no call management
    4, kClassSpecific, 0x02, 0x02,                  // line coding and line state
    5, kClassSpecific, 0x06, kControlInterface, kDataInterface, 7, kEndpoint, kNotifyEndpoint, kInterrupt, 8, 0, 16, 9,
    kInterface, kDataInterface, 0, 2, 0x0A, 0x00, 0x00, 0, 7, kEndpoint, kOutEndpoint, kBulk, kUsbPacketBytes, 0, 0, 7,
    kEndpoint, kInEndpoint, kBulk, kUsbPacketBytes, 0, 0,
    // Reset interface, the one that picotool knows: no endpoints
    9, kInterface, kResetInterface, 0, 0, kImuResetClass, kImuResetSubclass, kImuResetProtocol, 5};
// clang-format on
static_assert(kFirmwareVersion[0] < 10 && kFirmwareVersion[1] < 10 && kFirmwareVersion[2] < 10);  // one digit each
static_assert(kDeviceDescriptor[0] == kDeviceDescriptor.size());
static_assert(kConfigurationDescriptor[2] == kConfigurationDescriptor.size());

constexpr const char* text(std::uint8_t index) {
  switch (index) {
    case 1:
      return "slamd";
    case 2:
      return kImuUsbProductName;
    case 4:
      return "slamd IMU stream";
    case 5:
      return "slamd IMU reset";
    default:
      return "";
  }
}

constexpr char hex_digit(unsigned value) {
  return static_cast<char>(value < 10 ? '0' + value : 'A' + value - 10);
}

void append(StringDescriptor& descriptor, char character) {
  descriptor.bytes[descriptor.size++] = static_cast<std::uint8_t>(character);
  descriptor.bytes[descriptor.size++] = 0;
}

}  // namespace

std::span<const std::uint8_t> device_descriptor() {
  return kDeviceDescriptor;
}
std::span<const std::uint8_t> configuration_descriptor() {
  return kConfigurationDescriptor;
}

StringDescriptor string_descriptor(std::uint8_t index, const UniqueId& id) {
  StringDescriptor descriptor;
  if (index >= kUsbStringCount) return descriptor;
  descriptor.size = 2;
  if (index == 0) {
    descriptor.bytes[descriptor.size++] = 0x09;  // English (United States)
    descriptor.bytes[descriptor.size++] = 0x04;
  } else if (index == 3) {
    for (const std::uint8_t byte : id) {
      append(descriptor, hex_digit(byte >> 4U));
      append(descriptor, hex_digit(byte & 0xFU));
    }
  } else {
    for (const char* next = text(index); *next != '\0'; ++next) append(descriptor, *next);
  }
  descriptor.bytes[0] = descriptor.size;
  descriptor.bytes[1] = kString;
  return descriptor;
}

}  // namespace slamd
