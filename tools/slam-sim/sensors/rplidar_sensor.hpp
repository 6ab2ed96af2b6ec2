#pragma once
// An RPLIDAR A2 in a world: what its firmware puts on the serial port while it scans, packet by packet, every sample cast from the
// sensor's pose at its own time. It takes no commands (rplidar_device). Sources: Slamtec, RPLIDAR interface protocol v2.8; A2M8 data
// sheet (0.15 to 16 m, 8,000 samples and 10 revolutions a second, resolution 0.5 % of range).

#include "tools/slam-sim/sensors/lidar_model.hpp"

namespace slamd::sim {

/// What the firmware can do: newer ones more.
enum class RplidarFirmware : std::uint8_t { kStandard, kExpress, kBoost };

/// Of each: bytes of a packet on the wire, samples in it, microseconds from one to the next. A standard scan has one sample a packet; the
/// port hands over 32 together.
struct RplidarFormat {
  int bytes, samples, period_us;
};
RplidarFormat format_of(RplidarFirmware firmware);

class RplidarSensor final : public PacketSensor {
 public:
  RplidarSensor(const LidarModel& model, RplidarFirmware firmware, const Surroundings& around, SensorClock clock, std::uint64_t seed);

  double packet_time(std::int64_t index) const override;
  WireEvent packet(std::int64_t index) const override;

 private:
  struct Sample {
    double raw_deg;    // where the head stands, clockwise from its zero
    double angle_deg;  // where the echo comes from
    double range_m;    // 0 = none
  };
  Sample sample(std::int64_t number, const Movers& movers) const;
  std::vector<std::uint8_t> nodes(const std::vector<Sample>& samples) const;
  std::vector<std::uint8_t> express(const std::vector<Sample>& samples) const;
  std::vector<std::uint8_t> boost(const std::vector<Sample>& samples) const;

  LidarModel model_;
  RplidarFirmware firmware_;
  RplidarFormat format_;
  BeamCaster caster_;
  SensorClock clock_;
  std::uint64_t seed_;
};

}  // namespace slamd::sim
