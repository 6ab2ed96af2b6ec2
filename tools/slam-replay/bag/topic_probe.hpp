#pragma once
// The first messages of a topic, looked at before it is read: how its stamps stand to the recording's clock. It makes no items.

#include <optional>

#include "tools/slam-replay/bag/bag.hpp"
#include "tools/slam-replay/bag/topic_clock.hpp"

namespace slamd::replay {

struct TopicProbe {
  bool stamped = false;      // headers have times
  Duration least_lag{};      // of recording after stamp; only when stamped
  double period_s = 0.0;     // between stamps, in the middle; 0: unknown
  double accel_norm = 0.0;   // of Imu: of the specific force in the middle, in the message's unit
};

/// Reads some 50 messages.
TopicProbe probe(const Bag& bag, std::size_t topic);

/// How the stamps of topics that were probed become times: as they are when they are of one clock, even another one than the
/// recording's; else those of each topic that is not of the recording's are moved to it.
std::vector<TopicClock> clocks(const std::vector<TopicProbe>& probes);

}  // namespace slamd::replay
