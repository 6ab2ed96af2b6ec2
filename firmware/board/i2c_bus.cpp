#include "firmware/board/i2c_bus.hpp"

#include "firmware/board/interrupts.hpp"
#include "firmware/board/pins.hpp"
#include "firmware/board/registers.hpp"
#include "firmware/board/start_up.hpp"
#include "firmware/core/lsm6dsox.hpp"

namespace slamd::board {
namespace {

// 48 MHz: low 76 periods = 1.58 us, high 34 + 3 + 7 = 44 periods = 0.92 us, spikes up to 62 ns ignored, data held 312
// ns (data sheet 4.3.14). 400 kHz, with margin to the limits of fast mode: 1.3 us, 0.6 us, 50 ns, 300 ns of the other's
// edge.
constexpr std::uint32_t kLow = 75, kHigh = 34, kSpike = 3, kHold = 15;
constexpr Micros kHalfClock = 5;
constexpr int kClocksToFree = 9;

void pause() {
  const Micros end = now() + kHalfClock;
  while (now() < end) {
  }
}

/// Open drain: low by driving, high by letting go.
void drive(unsigned pin, bool high) {
  reg(high ? sio::kEnableClear : sio::kEnableSet) = bit(pin);
  pause();
}

bool is_high(unsigned pin) {
  return (reg(sio::kIn) & bit(pin)) != 0;
}

void set_function(std::uint32_t function) {
  reg(io_bank::control(kSdaPin)) = function;
  reg(io_bank::control(kSclPin)) = function;
}

}  // namespace

void I2cBus::read(std::uint8_t first, std::size_t count) {
  size_ = count;
  reg(i2c0::kDataCommand) = first;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t begin = i == 0 ? i2c0::kRestart : 0;
    const std::uint32_t end = i + 1 == count ? i2c0::kStop : 0;
    reg(i2c0::kDataCommand) = i2c0::kRead | begin | end;
  }
}

void I2cBus::write(std::uint8_t address, std::uint8_t value) {
  size_ = 0;
  reg(i2c0::kDataCommand) = address;
  reg(i2c0::kDataCommand) = i2c0::kStop | value;
}

BusState I2cBus::state() {
  const std::uint32_t events = reg(i2c0::kRawInterrupts);
  if ((events & i2c0::kStopped) == 0) return BusState::kBusy;
  const bool complete = (events & i2c0::kAborted) == 0 && reg(i2c0::kReceived) == size_;
  for (std::size_t i = 0; complete && i < size_; ++i) bytes_[i] = static_cast<std::uint8_t>(reg(i2c0::kDataCommand));
  [[maybe_unused]] const std::uint32_t cleared = reg(i2c0::kClearInterrupts);
  return complete ? BusState::kDone : BusState::kNoAnswer;
}

bool I2cBus::recover() {
  hold_in_reset(resets::kI2c0);
  drive(kSdaPin, true);
  drive(kSclPin, true);
  set_function(io_bank::kFunctionSio);
  for (int i = 0; i < kClocksToFree && !is_high(kSdaPin); ++i) {
    drive(kSclPin, false);
    drive(kSclPin, true);
  }
  // Stop: data rises while the clock is high. Every slave waits for a start then.
  drive(kSclPin, false);
  drive(kSdaPin, false);
  drive(kSclPin, true);
  drive(kSdaPin, true);
  const bool free = is_high(kSdaPin) && is_high(kSclPin);
  start_controller();
  set_function(io_bank::kFunctionI2c);
  return free;
}

void I2cBus::start_controller() {
  release_from_reset(resets::kI2c0);
  reg(i2c0::kControl) =
      i2c0::kMaster | i2c0::kFast | i2c0::kRestartEnable | i2c0::kSlaveDisable | i2c0::kTxEmptyControl;
  reg(i2c0::kTarget) = lsm6dsox::kBusAddress;
  reg(i2c0::kFastHigh) = kHigh;
  reg(i2c0::kFastLow) = kLow;
  reg(i2c0::kSpikeLength) = kSpike;
  reg(i2c0::kSdaHold) = kHold;
  reg(i2c0::kInterruptMask) = i2c0::kStopped | i2c0::kAborted;
  reg(i2c0::kEnable) = 1;
}

}  // namespace slamd::board
