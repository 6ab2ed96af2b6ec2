#pragma once
// The watchdog and what it knows about the last start. When it may be fed is decided by Device.

#include "firmware/protocol/reply.hpp"

namespace slamd::board {

/// Why the board started. Call once, before start_watchdog().
ResetCause reset_cause();

/// One second without feed_watchdog() starts the board anew.
void start_watchdog();
void feed_watchdog();

/// Starts the board anew, as by the command of that name.
[[noreturn]] void reset_board();

}  // namespace slamd::board
