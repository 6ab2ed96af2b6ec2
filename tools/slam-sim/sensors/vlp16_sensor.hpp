#pragma once
// A VLP-16 in a world: data packets by index, every firing cast from the sensor's pose at its own time. Nothing is
// sent. Sources: VLP-16 User Manual 63-9243 Rev. E, chapters 6 and 9, and its data sheet (63-9229).

#include <array>

#include "tools/slam-sim/sensors/lidar_model.hpp"

namespace slamd::sim {

class Vlp16Sensor final : public PacketSensor {
 public:
  Vlp16Sensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed);

  double packet_time(std::int64_t index) const override;
  WireEvent packet(std::int64_t index) const override;

 private:
  bool dual() const { return model_.mode == ReturnMode::kDual; }
  double packet_period() const;
  Echoes fire(double t, int laser, const Movers& movers, Rng& rng) const;

  LidarModel model_;
  BeamCaster caster_;
  SensorClock clock_;
  std::uint64_t seed_;
  std::array<double, 16> laser_bias_m_{};
};

}  // namespace slamd::sim
