#pragma once
// Interrupts: data-ready takes its time stamp, all others do no more than wake the main loop, which does all work. So
// nothing is shared between interrupts and loop but the stamp.

#include <cstdint>

#include "firmware/core/data_ready.hpp"
#include "firmware/core/micros.hpp"

namespace slamd::board {

/// Time since start. Reads the timer without its latches, so that interrupts may call it too.
Micros now();

/// Enables data-ready (highest priority), USB, I2C and a tick every millisecond. Call once, after clocks and pins.
void start_interrupts();

/// Edges of data-ready since start and the stamp of the newest, consistent.
DataReady data_ready();

/// Sleeps until an interrupt comes, or not at all when one came since the last call.
void wait_for_interrupt();

}  // namespace slamd::board
