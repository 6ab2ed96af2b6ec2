#pragma once
// Addresses and bits of the RP2040's registers that the firmware uses, from the RP2040 data sheet. No behaviour beyond
// reading and writing one register.

#include <cstdint>

namespace slamd::board {

using Address = std::uintptr_t;

/// The register at `address`.
inline volatile std::uint32_t& reg(Address address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
/// Atomic set and clear of bits, data sheet 2.1.2 (peripherals only, not SIO, not USB RAM).
inline void set_bits(Address address, std::uint32_t bits) {
  reg(address + 0x2000) = bits;
}
inline void clear_bits(Address address, std::uint32_t bits) {
  reg(address + 0x3000) = bits;
}

constexpr std::uint32_t bit(unsigned n) {
  return 1U << n;
}

namespace sysinfo {
constexpr Address kChipId = 0x40000000;  // revision in bits 31..28
}
namespace clocks {
constexpr Address kRefControl = 0x40008030, kRefSelected = 0x40008038;
constexpr Address kSysControl = 0x4000803C, kSysSelected = 0x40008044;
constexpr Address kUsbControl = 0x40008054;
constexpr std::uint32_t kRefFromCrystal = 2;
constexpr std::uint32_t kSysFromAux = 1, kSysAuxPllUsb = 1U << 5;
constexpr std::uint32_t kEnable = bit(11);  // its source 0 is the USB PLL
}  // namespace clocks
namespace resets {
constexpr Address kReset = 0x4000C000, kDone = 0x4000C008;
constexpr std::uint32_t kI2c0 = bit(3), kIoBank0 = bit(5), kPadsBank0 = bit(8), kPllUsb = bit(13), kSysInfo = bit(19),
                        kTimer = bit(21), kUsb = bit(24);
}  // namespace resets
namespace psm {
constexpr Address kWatchdogSelect = 0x40010008;
constexpr std::uint32_t kAllButOscillators = 0x0001FFFC;
}  // namespace psm
namespace io_bank {
constexpr Address control(unsigned gpio) {
  return 0x40014004 + 8 * gpio;
}
/// Four event bits a pin, eight pins a register.
constexpr Address event(unsigned gpio) {
  return 0x400140F0 + 4 * (gpio / 8);
}
constexpr Address event_enable(unsigned gpio) {
  return 0x40014100 + 4 * (gpio / 8);
}
constexpr std::uint32_t edge_rise(unsigned gpio) {
  return 8U << (4 * (gpio % 8));
}
constexpr std::uint32_t kFunctionI2c = 3, kFunctionSio = 5, kFunctionUsbPhy = 8;
constexpr std::uint32_t kOutputOff = 2U << 12, kInputHigh = 3U << 16;
}  // namespace io_bank
namespace io_qspi {
constexpr Address kChipSelectControl = 0x4001800C;
constexpr std::uint32_t kOutputLow = 2U << 8, kOutputHigh = 3U << 8, kOutputMask = 3U << 8;
}  // namespace io_qspi
namespace pads {
constexpr Address pad(unsigned gpio) {
  return 0x4001C004 + 4 * gpio;
}
constexpr std::uint32_t kSchmitt = bit(1), kPullDown = bit(2), kPullUp = bit(3), kDrive4mA = 1U << 4, kInput = bit(6);
}  // namespace pads
namespace crystal {
constexpr Address kControl = 0x40024000, kStatus = 0x40024004, kStartup = 0x4002400C;
constexpr std::uint32_t kRange1To15MHz = 0xAA0, kEnable = 0xFAB000, kStable = bit(31);
}  // namespace crystal
namespace pll_usb {
constexpr Address kControl = 0x4002C000, kPower = 0x4002C004, kFeedback = 0x4002C008, kPostDividers = 0x4002C00C;
constexpr std::uint32_t kLocked = bit(31);
constexpr std::uint32_t kPowerDown = bit(0), kPostDividerDown = bit(3), kVcoDown = bit(5);
}  // namespace pll_usb
namespace i2c0 {
constexpr Address kControl = 0x40044000, kTarget = 0x40044004, kDataCommand = 0x40044010, kFastHigh = 0x4004401C,
                  kFastLow = 0x40044020, kInterruptMask = 0x40044030, kRawInterrupts = 0x40044034,
                  kClearInterrupts = 0x40044040, kEnable = 0x4004406C, kReceived = 0x40044078, kSdaHold = 0x4004407C,
                  kSpikeLength = 0x400440A0;
constexpr std::uint32_t kMaster = bit(0), kFast = 2U << 1, kRestartEnable = bit(5), kSlaveDisable = bit(6),
                        kTxEmptyControl = bit(8);
constexpr std::uint32_t kRead = bit(8), kStop = bit(9), kRestart = bit(10);
constexpr std::uint32_t kAborted = bit(6), kStopped = bit(9);
}  // namespace i2c0
namespace timer {
constexpr Address kAlarm0 = 0x40054010, kRawHigh = 0x40054024, kRawLow = 0x40054028, kEvent = 0x40054034,
                  kEventEnable = 0x40054038;
}
namespace watchdog {
constexpr Address kControl = 0x40058000, kLoad = 0x40058004, kReason = 0x40058008, kScratch0 = 0x4005800C,
                  kTick = 0x4005802C;
constexpr std::uint32_t kTrigger = bit(31), kEnable = bit(30), kPauseInDebug = 7U << 24;
constexpr std::uint32_t kReasonTimer = bit(0);
constexpr std::uint32_t kTickEnable = bit(9);
}  // namespace watchdog
namespace chip_reset {
constexpr Address kCause = 0x40064008;
constexpr std::uint32_t kHadRun = bit(16);
}  // namespace chip_reset
namespace ssi {
constexpr Address kStatus = 0x18000028, kData = 0x18000060;
constexpr std::uint32_t kTransmitNotFull = bit(1), kReceiveNotEmpty = bit(3);
}  // namespace ssi
namespace sio {
constexpr Address kIn = 0xD0000004, kOutSet = 0xD0000014, kOutClear = 0xD0000018, kEnableSet = 0xD0000024,
                  kEnableClear = 0xD0000028;
}
namespace nvic {
constexpr Address kSetEnable = 0xE000E100, kClearEnable = 0xE000E180, kClearPending = 0xE000E280,
                  kPriority = 0xE000E400;
constexpr unsigned kTimer0 = 0, kUsb = 5, kIoBank0 = 13, kI2c0 = 23;
}  // namespace nvic

}  // namespace slamd::board
