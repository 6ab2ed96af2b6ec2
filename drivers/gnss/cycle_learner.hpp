#pragma once
// Learns which sentence ends a receiver's cycle, so that a fix need not wait for the next second. Knows no contents.

#include <array>
#include <cstdint>

#include "drivers/gnss/nmea_sentence.hpp"

namespace slamd {

/// One thread uses an instance; no allocation.
class CycleLearner {
 public:
  /// A sentence of the running cycle arrived.
  void note(NmeaType type);
  /// The newest sentence is the one that ended the last cycles. Never true before kFewestCycles of them agreed.
  bool at_end() const;
  /// A new cycle begins: what was noted is learnt.
  void end_cycle();

 private:
  static constexpr std::uint32_t kFewestCycles = 2;
  struct Habit {
    std::uint32_t count = 0;        // in the running cycle
    std::uint32_t position = 0;     // of its last occurrence there, from 1
    std::uint32_t usual_count = 0;  // in the cycle before,
    std::uint32_t cycles = 0;       // and in so many in a row
  };

  std::array<Habit, kNmeaTypes> habits_{};
  std::uint32_t noted_ = 0;
  NmeaType newest_ = NmeaType::kOther;
  NmeaType last_ = NmeaType::kOther;  // of the cycle, as learnt
  bool first_cycle_ = true;           // may have been joined in its middle
};

}  // namespace slamd
