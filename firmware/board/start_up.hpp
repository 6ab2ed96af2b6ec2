#pragma once
// Clocks, resets and pins at start-up: the only place of the firmware that may wait (some 10 ms for the crystal).

#include <cstdint>

namespace slamd::board {

/// Crystal 12 MHz -> USB PLL 48 MHz -> everything; timer ticks of 1 us from the crystal. One PLL: less power, less heat
/// beside the sensor, and the USB controller and its registers run on one clock.
void start_clocks();

/// Starts peripherals (bits of resets::kReset) from a known state.
void hold_in_reset(std::uint32_t blocks);
void release_from_reset(std::uint32_t blocks);

/// LED, sensor bus and data-ready pin.
void start_pins();

void set_led(bool on);

}  // namespace slamd::board
