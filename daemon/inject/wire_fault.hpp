#pragma once
// Failures of a wire, played on the bytes between a port and its parser: off, garbage, delayed, intermittent. It knows no
// protocol; what needs values is in value_fault.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/inject/fault_switch.hpp"

namespace slamd {

/// How a failure looks on one wire.
struct WireFaultShape {
  Duration delay;             // of delayed bytes
  Duration period;            // of intermittent ones: half of it nothing comes
  std::size_t held_reads;     // that fit into the delay; beyond it the oldest are lost
  std::size_t read_bytes;     // longest read; a longer one is cut into several
};

/// One thread. Takes all its memory at once.
class WireFault {
 public:
  /// verbs must outlive it.
  WireFault(const FaultSwitch& verbs, const WireFaultShape& shape);

  /// A read of the port, empty when nothing came, at host time `now`, never going back. Calls sink(bytes, arrival) for
  /// what gets through: at once, later or never. No allocation.
  template <class Sink>
  void pass(std::span<const std::uint8_t> bytes, HostTime now, Sink&& sink) {
    const FaultVerb verb = verbs_.verb(now);
    const bool late = verb == FaultVerb::kDelayed;
    if (late) hold(bytes, now);
    while (const Held* held = oldest(late ? now - shape_.delay : now)) {
      sink(std::span{held->bytes.data(), held->size}, now);
      drop_oldest();
    }
    if (late || bytes.empty() || is_cut(verb, now)) return;
    sink(verb == FaultVerb::kGarbage ? damaged(bytes) : bytes, now);
  }

 private:
  struct Held {
    HostTime arrival;
    std::size_t size = 0;
    std::vector<std::uint8_t> bytes;
  };

  bool is_cut(FaultVerb verb, HostTime now) const;
  void hold(std::span<const std::uint8_t> bytes, HostTime now);
  /// That came until then; null when none waits.
  const Held* oldest(HostTime until) const;
  void drop_oldest();
  std::span<const std::uint8_t> damaged(std::span<const std::uint8_t> bytes);

  const FaultSwitch& verbs_;
  WireFaultShape shape_;
  std::vector<Held> held_;  // a ring
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::vector<std::uint8_t> noisy_;
  std::uint64_t noise_ = 0x9E3779B97F4A7C15U;  // the same noise in every run
};

}  // namespace slamd
