#include "drivers/robosense/airy_imu_parser.hpp"

#include "drivers/robosense/airy_imu_packet.hpp"

namespace slamd {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{5};

}  // namespace

AiryImuParser::Config AiryImuParser::Config::defaults() {
  Config config;
  config.clock.min_latency = Duration{300'000};
  return config;
}

std::optional<ImuSample> AiryImuParser::take(std::span<const std::uint8_t> bytes, HostTime arrival) {
  const Result<AiryImuReading> reading = parse_airy_imu(bytes);
  if (!reading) {
    ++stats_.malformed;
    return std::nullopt;
  }
  const PacketAdmission admission = timeline_.admit({.begin = reading->stamp, .arrival = arrival}, kPeriod);
  if (admission.verdict != PacketVerdict::kAdmitted) {
    ++(admission.verdict == PacketVerdict::kStampJump ? stats_.implausible : stats_.repeated);
    return std::nullopt;
  }
  ++stats_.samples;
  stats_.missing += admission.lost_packets;
  stats_.resets += admission.jumped ? 1 : 0;
  stats_.clipped += reading->clipped ? 1 : 0;
  ImuSample sample;
  sample.time = clock_.update(reading->stamp, arrival);
  sample.arrival = arrival;
  sample.gyro_rads = reading->gyro_rads;
  sample.accel_mps2 = reading->accel_mps2;
  sample.clipped = reading->clipped;
  sample.clock_unsure = clock_.is_recovering();
  return sample;
}

}  // namespace slamd
