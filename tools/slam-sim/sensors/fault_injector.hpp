#pragma once
// Loses, damages, delays and repeats events on their way to the host. Clock and GPS position faults are the sensors'.

#include <array>
#include <optional>

#include "tools/slam-sim/sensors/fault.hpp"
#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

class FaultInjector {
 public:
  FaultInjector(std::vector<Fault> faults, std::uint64_t seed)
      : faults_{std::move(faults)}, rng_{seed, Stream::kFault} {}

  /// What becomes of an event; nothing when it is lost. Events of one channel come in order.
  std::optional<WireEvent> apply(WireEvent event);

 private:
  bool apply_one(const Fault& fault, WireEvent& event);
  void repeat_last(WireEvent& event);

  std::vector<Fault> faults_;
  Rng rng_;
  std::array<std::vector<WireEvent>, kChannels> healthy_;  // the last measurement: one event, several sentences for GPS
  std::array<std::size_t, kChannels> replayed_{};
};

}  // namespace slamd::sim
