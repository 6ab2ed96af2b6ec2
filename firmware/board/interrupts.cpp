#include "firmware/board/interrupts.hpp"

#include <initializer_list>

#include "firmware/board/pins.hpp"
#include "firmware/board/registers.hpp"

namespace slamd::board {
namespace {

constexpr std::uint32_t kTickUs = 1000;
constexpr std::uint32_t kWakingLines = bit(nvic::kTimer0) | bit(nvic::kUsb) | bit(nvic::kI2c0);

/// Written by the data-ready interrupt only. The edge count changes last, so a reader who finds it unchanged has a
/// whole stamp.
struct Mailbox {
  static inline volatile std::uint32_t edges = 0;
  static inline volatile std::uint32_t stamp_low = 0;
  static inline volatile std::uint32_t stamp_high = 0;
};

void next_tick() {
  reg(timer::kEvent) = 1;
  reg(timer::kAlarm0) = reg(timer::kRawLow) + kTickUs;
}

/// One byte a line; the upper two bits count, 0 is the most urgent.
void set_priority(unsigned line, std::uint32_t priority) {
  const Address at = nvic::kPriority + (line & ~3U);
  const unsigned shift = 8 * (line % 4);
  reg(at) = (reg(at) & ~(0xFFU << shift)) | priority << shift;
}

}  // namespace

Micros now() {
  for (;;) {
    const std::uint32_t high = reg(timer::kRawHigh);
    const std::uint32_t low = reg(timer::kRawLow);
    if (reg(timer::kRawHigh) == high) return Micros{high} << 32U | low;
  }
}

extern "C" void on_data_ready() {
  const Micros stamp = now();
  reg(io_bank::event(kDataReadyPin)) = io_bank::edge_rise(kDataReadyPin);
  Mailbox::stamp_low = static_cast<std::uint32_t>(stamp);
  Mailbox::stamp_high = static_cast<std::uint32_t>(stamp >> 32U);
  Mailbox::edges = Mailbox::edges + 1;
}

/// The line stays off until the main loop has served its cause.
extern "C" void on_wake() {
  std::uint32_t exception;
  asm volatile("mrs %0, ipsr" : "=r"(exception));
  reg(nvic::kClearEnable) = bit((exception & 0x3FU) - 16);
}

void start_interrupts() {
  for (const unsigned line : {nvic::kTimer0, nvic::kUsb, nvic::kI2c0}) set_priority(line, 0xC0);
  set_priority(nvic::kIoBank0, 0);
  reg(io_bank::event(kDataReadyPin)) = io_bank::edge_rise(kDataReadyPin);
  set_bits(io_bank::event_enable(kDataReadyPin), io_bank::edge_rise(kDataReadyPin));
  reg(timer::kEventEnable) = 1;
  next_tick();
  reg(nvic::kClearPending) = kWakingLines | bit(nvic::kIoBank0);
  reg(nvic::kSetEnable) = kWakingLines | bit(nvic::kIoBank0);
}

DataReady data_ready() {
  for (;;) {
    const std::uint32_t edges = Mailbox::edges;
    const Micros stamp = Micros{Mailbox::stamp_high} << 32U | Mailbox::stamp_low;
    if (Mailbox::edges == edges) return {edges, stamp};
  }
}

void wait_for_interrupt() {
  if ((reg(timer::kEvent) & 1U) != 0) next_tick();
  reg(nvic::kSetEnable) = kWakingLines;
  // Every interrupt sets the core's event flag, which WFE tests and clears: none can slip in between.
  asm volatile("wfe" ::: "memory");
}

}  // namespace slamd::board
