// The tables of keys: one line says the key, where it lives, its unit, its range and its meaning.

#include "daemon/config/config.hpp"

namespace slamd {
namespace {

constexpr FieldRange kPriority{0, 99};
constexpr FieldRange kCpu{-1, 1023};

using Fields = std::vector<Field>;

void append(Fields& fields, Fields more) {
  fields.insert(fields.end(), more.begin(), more.end());
}

Fields real_time_fields(RealTimeConfig& c) {
  return {
      {"real_time.lock_memory",
       &c.lock_memory,
       "",
       {},
       "lock all memory so that nothing is paged out (when permitted)"},
      {"real_time.imu_priority", &c.imu_priority, "", kPriority, "SCHED_FIFO priority; 0 = normal scheduling"},
      {"real_time.lidar_priority", &c.lidar_priority, "", kPriority, "likewise"},
      {"real_time.gnss_priority", &c.gnss_priority, "", kPriority, "likewise"},
      {"real_time.estimator_priority", &c.estimator_priority, "", kPriority, "likewise"},
      {"real_time.driver_cpu", &c.driver_cpu, "", kCpu, "CPU of the three driver threads; -1 = any"},
      {"real_time.estimator_cpu", &c.estimator_cpu, "", kCpu, "CPU of the estimator thread; -1 = any"},
  };
}

}  // namespace

Fields vehicle_fields(VehicleGeometry& v, const std::string& prefix) {
  constexpr FieldRange kMetres{-50, 50};
  return {
      {prefix + "T_base_lidar.translation_m", &v.T_base_lidar.translation, "m", kMetres, "lidar origin in base"},
      {prefix + "T_base_lidar.rotation_quat_xyzw", &v.T_base_lidar.rotation, "", {-1, 1}, "rotates lidar into base"},
      {prefix + "T_base_imu.translation_m", &v.T_base_imu.translation, "m", kMetres, "imu origin in base"},
      {prefix + "T_base_imu.rotation_quat_xyzw", &v.T_base_imu.rotation, "", {-1, 1}, "rotates imu into base"},
      {prefix + "p_base_antenna", &v.p_base_antenna, "m", kMetres, "phase centre of the GPS antenna in base"},
  };
}

Fields config_fields(Config& c) {
  Fields fields = vehicle_fields(c.vehicle, "vehicle.");
  append(fields, real_time_fields(c.real_time));
  return fields;
}

VehicleGeometry reference_vehicle() {
  VehicleGeometry v;
  v.T_base_lidar = {{0.995396198367, 0.0, 0.095845752520, 0.0}, {0.45, 0.02, 1.86}};
  v.T_base_imu = {{0.699404695268, 0.019093388559, 0.003285447570, 0.714463239491}, {0.12, -0.08, 1.52}};
  v.p_base_antenna = {-0.60, 0.35, 1.74};
  return v;
}

}  // namespace slamd
