#pragma once
// The VLP-16's position packets (port 8308): its clock, the state of PPS, and the sentence of its own receiver.

#include "tools/slam-sim/sensors/gps_sensor.hpp"
#include "tools/slam-sim/sensors/lidar_model.hpp"

namespace slamd::sim {

class PositionSensor final : public PacketSensor {
 public:
  PositionSensor(const LidarModel& lidar, const GpsModel& gps, const Trajectory& trajectory, SensorClock clock,
                 std::uint64_t seed);

  /// True time of packet `index`, seconds; one every 18.577 ms.
  double packet_time(std::int64_t index) const override;
  WireEvent packet(std::int64_t index) const override;

 private:
  LidarModel lidar_;
  GpsModel gps_;
  const Trajectory& trajectory_;
  SensorClock clock_;
  std::uint64_t seed_;
};

}  // namespace slamd::sim
