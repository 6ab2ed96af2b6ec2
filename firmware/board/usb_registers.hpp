#pragma once
// Registers, RAM layout and bits of the RP2040's USB controller in device mode (RP2040 data sheet 4.1). No behaviour.

#include <cstdint>

#include "firmware/board/registers.hpp"

namespace slamd::board::usb {

// RAM of the controller: setup packet, endpoint controls, buffer controls, buffers.
constexpr Address kRam = 0x50100000;
constexpr Address kRamEnd = kRam + 0x1000;
constexpr Address endpoint_control_in(unsigned n) {
  return kRam + 8 * n;
}
constexpr Address endpoint_control_out(unsigned n) {
  return kRam + 8 * n + 4;
}
constexpr Address buffer_control_in(unsigned n) {
  return kRam + 0x80 + 8 * n;
}
constexpr Address buffer_control_out(unsigned n) {
  return kRam + 0x84 + 8 * n;
}
constexpr Address kBuffer0 = kRam + 0x100;
constexpr Address kNotifyBuffer = kRam + 0x180, kOutBuffer = kRam + 0x1C0, kInBuffer = kRam + 0x200;

constexpr std::uint32_t kEndpointEnable = bit(31), kEndpointInterrupt = bit(29);
constexpr std::uint32_t kTypeBulk = 2U << 26, kTypeInterrupt = 3U << 26;

constexpr std::uint32_t kFull = bit(15), kData1 = bit(13), kStall = bit(11), kAvailable = bit(10), kLengthMask = 0x3FF;

constexpr Address kAddress = 0x50110000, kMainControl = 0x50110040, kSieControl = 0x5011004C, kSieStatus = 0x50110050,
                  kBufferStatus = 0x50110058, kStallArm = 0x50110068, kMuxing = 0x50110074, kPower = 0x50110078,
                  kPhyDirect = 0x5011007C, kPhyOverride = 0x50110080, kInterruptEnable = 0x50110090,
                  kInterrupts = 0x50110098;

constexpr std::uint32_t kControllerEnable = bit(0);
constexpr std::uint32_t kInterruptPerBuffer0 = bit(29), kPullUp = bit(16);
constexpr std::uint32_t kStatusBusReset = bit(19), kStatusSetup = bit(17), kStatusConnected = bit(16),
                        kStatusResume = bit(11), kStatusSuspended = bit(4), kLineStateMask = 3U << 2;
constexpr std::uint32_t kToPhy = bit(0), kToDigitalPad = bit(2), kSoftConnect = bit(3);
constexpr std::uint32_t kVbusDetected = bit(3), kVbusOverride = bit(2);
constexpr std::uint32_t kPhyPullUp = bit(1), kPhyPullUpOverride = bit(2);
constexpr std::uint32_t kEventSetup = bit(16), kEventResume = bit(15), kEventSuspend = bit(14),
                        kEventBusReset = bit(12), kEventBuffer = bit(4);

}  // namespace slamd::board::usb
