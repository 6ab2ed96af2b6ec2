#pragma once
// Work-around of erratum RP2040-E5: after a bus reset the controller of chip revisions B0 and B1 waits for 800 us of
// idle bus, which never come behind a busy hub. Shows it an idle bus for 1 ms over the debug input of GPIO15. Never
// waits.

#include <cstdint>

#include "firmware/core/micros.hpp"

namespace slamd::board {

class UsbConnectFix {
 public:
  /// The bus was reset.
  void begin();
  /// Next step, called by the main loop at least every millisecond.
  void step(Micros now);

 private:
  enum class State : std::uint8_t { kOff, kAwaitEndOfReset, kForced };

  void force_idle();
  void release();

  State state_ = State::kOff;
  Micros forced_at_ = 0;
  std::uint32_t pad_ = 0;      // of GPIO15 before
  std::uint32_t control_ = 0;  // likewise
};

}  // namespace slamd::board
