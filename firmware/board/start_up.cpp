#include "firmware/board/start_up.hpp"

#include "firmware/board/pins.hpp"
#include "firmware/board/registers.hpp"

namespace slamd::board {
namespace {

// Crystal: 8 ms to settle, in units of 256 periods. PLL: 12 MHz * 100 = 1200 MHz / 5 / 5 = 48 MHz.
constexpr std::uint32_t kCrystalStartup = 8 * 12'000 / 256;
constexpr std::uint32_t kPllFeedback = 100;
constexpr std::uint32_t kPllPostDividers = 5U << 16 | 5U << 12;
constexpr std::uint32_t kCrystalPeriodsPerMicrosecond = 12;

}  // namespace

void hold_in_reset(std::uint32_t blocks) {
  set_bits(resets::kReset, blocks);
}

void release_from_reset(std::uint32_t blocks) {
  hold_in_reset(blocks);
  clear_bits(resets::kReset, blocks);
  while ((reg(resets::kDone) & blocks) != blocks) {
  }
}

void start_clocks() {
  reg(crystal::kStartup) = kCrystalStartup;
  reg(crystal::kControl) = crystal::kRange1To15MHz;
  set_bits(crystal::kControl, crystal::kEnable);
  while ((reg(crystal::kStatus) & crystal::kStable) == 0) {
  }
  // Both clocks leave the PLL, if they were on it, before it is set up anew.
  clear_bits(clocks::kSysControl, clocks::kSysFromAux);
  while (reg(clocks::kSysSelected) != 1U) {
  }
  reg(clocks::kRefControl) = clocks::kRefFromCrystal;
  while (reg(clocks::kRefSelected) != bit(clocks::kRefFromCrystal)) {
  }
  release_from_reset(resets::kPllUsb);
  reg(pll_usb::kControl) = 1;  // the crystal undivided
  reg(pll_usb::kFeedback) = kPllFeedback;
  clear_bits(pll_usb::kPower, pll_usb::kPowerDown | pll_usb::kVcoDown);
  while ((reg(pll_usb::kControl) & pll_usb::kLocked) == 0) {
  }
  reg(pll_usb::kPostDividers) = kPllPostDividers;
  clear_bits(pll_usb::kPower, pll_usb::kPostDividerDown);

  reg(clocks::kSysControl) = clocks::kSysAuxPllUsb;
  set_bits(clocks::kSysControl, clocks::kSysFromAux);
  while (reg(clocks::kSysSelected) != bit(clocks::kSysFromAux)) {
  }
  reg(clocks::kUsbControl) = clocks::kEnable;
  reg(watchdog::kTick) = watchdog::kTickEnable | kCrystalPeriodsPerMicrosecond;
  release_from_reset(resets::kTimer);
}

void start_pins() {
  release_from_reset(resets::kIoBank0 | resets::kPadsBank0);
  reg(sio::kOutClear) = bit(kLedPin) | bit(kSdaPin) | bit(kSclPin);
  reg(sio::kEnableSet) = bit(kLedPin);
  reg(io_bank::control(kLedPin)) = io_bank::kFunctionSio;
  reg(pads::pad(kLedPin)) = pads::kDrive4mA | pads::kInput;
  reg(pads::pad(kSdaPin)) = pads::kInput | pads::kSchmitt | pads::kPullUp | pads::kDrive4mA;
  reg(pads::pad(kSclPin)) = pads::kInput | pads::kSchmitt | pads::kPullUp | pads::kDrive4mA;
  reg(pads::pad(kDataReadyPin)) = pads::kInput | pads::kSchmitt | pads::kPullDown;
  reg(io_bank::control(kDataReadyPin)) = io_bank::kFunctionSio;
}

void set_led(bool on) {
  reg(on ? sio::kOutSet : sio::kOutClear) = bit(kLedPin);
}

}  // namespace slamd::board
