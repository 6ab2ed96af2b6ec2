#pragma once
// What the LED shows. The pin is the board's.

#include <cstdint>

#include "firmware/core/micros.hpp"

namespace slamd {

enum class LedState : std::uint8_t {
  kDark,       // the bus sleeps
  kFault,      // four flashes a second: the sensor is lost
  kWaiting,    // a short flash a second: ready, nobody reads
  kStreaming,  // on
};

/// Periods are powers of two of a microsecond (1.05 s, 0.26 s): the core divides slowly.
constexpr bool led_on(LedState state, Micros now) {
  const auto low = static_cast<std::uint32_t>(now);
  switch (state) {
    case LedState::kDark:
      return false;
    case LedState::kFault:
      return (low >> 17U & 1U) == 0;
    case LedState::kWaiting:
      return (low & 0xFFFFFU) < 50'000;
    case LedState::kStreaming:
      return true;
  }
  return false;
}

}  // namespace slamd
