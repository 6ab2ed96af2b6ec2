#pragma once
// A RoboSense Airy in a world: data and device packets by index, every firing cast from the sensor's pose at its own time, and the
// packets of its IMU. Nothing is sent. Sources: Airy User Guide 1.2 and data sheet (60 m, 0.1 m near, 0.4 degrees, +-2 cm).

#include <array>
#include <optional>

#include "tools/slam-sim/sensors/imu_sensor.hpp"
#include "tools/slam-sim/sensors/lidar_model.hpp"

namespace slamd::sim {

/// Directions of one unit's 96 beams: nominal ones and what its calibration says of them.
struct AiryUnit {
  static constexpr int kChannels = 96;
  std::array<int, kChannels> elevation_cdeg{};
  std::array<int, kChannels> azimuth_offset_cdeg{};  // clockwise
  explicit AiryUnit(std::uint64_t seed);
};

/// Where the IMU sits in the sensor's frame.
Pose airy_imu_in_lidar();

class AirySensor final : public PacketSensor {
 public:
  AirySensor(const LidarModel& model, const Surroundings& around, SensorClock clock, std::uint64_t seed);

  double packet_time(std::int64_t index) const override;
  WireEvent packet(std::int64_t index) const override;

 private:
  bool dual() const { return model_.mode == ReturnMode::kDual; }
  double turn_rate() const;
  Echoes fire(double column_time, int channel, const Movers& movers, Rng& rng) const;

  LidarModel model_;
  BeamCaster caster_;
  SensorClock clock_;
  std::uint64_t seed_;
  AiryUnit unit_;
  std::array<double, AiryUnit::kChannels> bias_m_{};
};

/// Its device packets, two a second.
class AiryDeviceSensor final : public PacketSensor {
 public:
  AiryDeviceSensor(const LidarModel& model, std::uint64_t seed);

  double packet_time(std::int64_t index) const override;
  WireEvent packet(std::int64_t index) const override;

 private:
  LidarModel model_;
  std::uint64_t seed_;
  std::vector<std::uint8_t> bytes_;
};

/// Its IMU: true motion in, packets out, in order.
class AiryImuSensor {
 public:
  /// imu  what its errors are; the sensor's own clock
  AiryImuSensor(const ImuModel& imu, const Trajectory& trajectory, const Pose& T_base_lidar, SensorClock clock, std::uint64_t seed);

  /// The next packet taken before `until` (seconds).
  std::optional<WireEvent> next(double until);

 private:
  SensorClock clock_;
  ImuSensor imu_;
};

}  // namespace slamd::sim
