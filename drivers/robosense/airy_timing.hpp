#pragma once
// When each channel of an Airy fires after its column begins, and where its optical centre sits. Constants only. Sources: Airy
// User Guide 1.2, "transmission delay of the channels", and the constants that the manufacturer's own driver names.

#include <array>
#include <cstddef>

#include "drivers/robosense/airy_packet.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

constexpr Duration kAiryColumn{111'080};  // from one column of 96 firings to the next: 900 a turn at 600 rpm
constexpr std::size_t kAiryGroup = 8;     // channels that fire together
constexpr std::array<Duration, kAiryChannels / kAiryGroup> kAiryGroupDelay = {
    Duration{0},      Duration{7'616},  Duration{16'184}, Duration{24'752}, Duration{33'320}, Duration{42'840},
    Duration{52'360}, Duration{61'880}, Duration{71'400}, Duration{79'968}, Duration{88'536}, Duration{97'104}};

/// Firing time of channel 0..95 after its column's begin.
constexpr Duration airy_channel_delay(std::size_t channel) { return kAiryGroupDelay[channel / kAiryGroup]; }

/// From a packet's first firing to the first of the next packet: 444.32 us, dual return 222.16 us.
constexpr Duration airy_packet_span(AiryReturns returns) {
  return static_cast<int>(airy_columns(returns)) * kAiryColumn;
}

/// Beams begin this far above the sensor's origin (the middle of its foot), and this far out in the direction of the column.
constexpr float kAiryCentreHeight_m = 0.06056F;
constexpr float kAiryCentreRadius_m = 0.011433F;

}  // namespace slamd
