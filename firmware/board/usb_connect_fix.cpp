#include "firmware/board/usb_connect_fix.hpp"

#include "firmware/board/usb_registers.hpp"

namespace slamd::board {
namespace {

constexpr unsigned kDebugPin = 15;  // D3 of the board, free
constexpr Micros kForcedFor = 1'000;
constexpr Micros kForcedAtMost = 5'000;        // the host speaks 10 ms after the reset
constexpr std::uint32_t kRevisionWithFix = 2;  // B2

bool needed() {
  return (reg(sysinfo::kChipId) >> 28U) < kRevisionWithFix;
}

}  // namespace

void UsbConnectFix::begin() {
  if (state_ == State::kForced) release();
  state_ = needed() ? State::kAwaitEndOfReset : State::kOff;
}

void UsbConnectFix::step(Micros now) {
  if (state_ == State::kOff) return;
  const std::uint32_t status = reg(usb::kSieStatus);
  if (state_ == State::kAwaitEndOfReset) {
    if ((status & usb::kLineStateMask) == 0) return;
    force_idle();
    forced_at_ = now;
    state_ = State::kForced;
    return;
  }
  const Micros forced_for = now - forced_at_;
  if (forced_for < kForcedFor || ((status & usb::kStatusConnected) == 0 && forced_for < kForcedAtMost)) return;
  release();
  state_ = State::kOff;
}

/// The controller takes its inputs from pads instead of the USB transceiver: D+ reads high by override, D- low, which
/// is the idle line of full speed. The pull-up of the real line stays on and the pin itself drives nothing.
void UsbConnectFix::force_idle() {
  pad_ = reg(pads::pad(kDebugPin));
  control_ = reg(io_bank::control(kDebugPin));
  reg(pads::pad(kDebugPin)) = pad_ | pads::kPullUp | pads::kPullDown;
  reg(io_bank::control(kDebugPin)) = io_bank::kFunctionUsbPhy | io_bank::kOutputOff | io_bank::kInputHigh;
  set_bits(usb::kPhyDirect, usb::kPhyPullUp);
  set_bits(usb::kPhyOverride, usb::kPhyPullUpOverride);
  reg(usb::kMuxing) = usb::kToDigitalPad | usb::kSoftConnect;
}

void UsbConnectFix::release() {
  reg(usb::kMuxing) = usb::kToPhy | usb::kSoftConnect;
  clear_bits(usb::kPhyOverride, usb::kPhyPullUpOverride);
  reg(io_bank::control(kDebugPin)) = control_;
  reg(pads::pad(kDebugPin)) = pad_;
}

}  // namespace slamd::board
