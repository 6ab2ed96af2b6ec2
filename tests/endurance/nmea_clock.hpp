#pragma once
// Moves the clock of an NMEA sentence on. Reads and changes nothing but its time and date.

#include <cstdint>
#include <vector>

namespace slamd::endurance {

/// sentence  as on the wire, one; any other bytes stay as they are. by_s  whole seconds, also over midnight
void move_sentence(std::vector<std::uint8_t>& sentence, std::int64_t by_s);

}  // namespace slamd::endurance
