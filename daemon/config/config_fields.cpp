// The tables of keys: one line says the key, where it lives, its unit, its range and its meaning. Those of the
// estimator are in odometry_fields.cpp.

#include "daemon/config/back_end_fields.hpp"
#include "daemon/config/config.hpp"
#include "daemon/config/odometry_fields.hpp"
#include "daemon/config/planar_fields.hpp"

namespace slamd {
namespace {

constexpr FieldRange kPort{1, 65535};
constexpr FieldRange kPriority{0, 99};
constexpr FieldRange kCpu{-1, 1023};
constexpr FieldRange kLatency{0, 0.5};
constexpr bool kLive = true;

using Fields = std::vector<Field>;

void append(Fields& fields, Fields more) {
  fields.insert(fields.end(), more.begin(), more.end());
}

Fields lidar_fields(LidarThreadConfig& t, LidarDecoderConfig& d) {
  return {
      {"lidar.model", &t.model, "", kSomeText, "vlp16, airy (RoboSense) or rplidar_a2 (Slamtec, in one plane); config/ has a file for each"},
      {"lidar.bind_address", &t.bind_address, "", kSomeText, "own IPv4 address to listen on; 0.0.0.0 = all"},
      {"lidar.port", &t.port, "", kPort, "UDP port of the data packets (Airy: 6699)"},
      {"lidar.position_port", &t.position_port, "", kPort, "UDP port of the position packets; Airy: of the device packets (7788)"},
      {"lidar.source_address", &t.source_address, "", kAnyText, "take packets of this sensor only; empty = of any"},
      {"lidar.source_port", &t.source_port, "", {0, 65535},
       "take data packets sent from this port only (2368 of a VLP-16 as delivered); 0 = of any"},
      {"lidar.position_source_port", &t.position_source_port, "", {0, 65535},
       "likewise position packets (8308); 0 = of any"},
      {"lidar.receive_buffer_bytes",
       &t.receive_buffer_bytes,
       "B",
       {65536, 1 << 28},
       "asked of the kernel for each port"},
      {"lidar.device", &t.serial.path, "", kAnyText, "of an RPLIDAR: its serial port"},
      {"lidar.baud_rate", &t.serial.baud, "Bd", {1200, 4'000'000}, "likewise; 115200 of an A2"},
      {"lidar.latency_s", &d.clock.min_latency, "s", kLatency,
       "smallest delay from a packet's last firing to its arrival"},
      {"lidar.min_range_m", &d.min_range_m, "m", {0, 100}, "nearer returns are dropped"},
      {"lidar.max_range_m", &d.max_range_m, "m", {1, 131}, "farther returns are dropped"},
      {"lidar.vertical_offsets", &d.vertical_offsets, "", {},
       "VLP-16: rays begin at the manual's heights, as in the real sensor; false = at one point"},
  };
}

Fields imu_fields(ImuThreadConfig& t, ImuFrameParser::Config& d) {
  return {
      {"imu.source",
       &t.source.kind,
       "",
       {3, 6},
       "serial = through the tty; usb = from the board's endpoint, without one"},
      {"imu.device", &t.source.serial.path, "", kAnyText, "for serial: tty or pty of the IMU; empty = there is none"},
      {"imu.usb_serial", &t.source.usb_serial, "", kAnyText,
       "for usb: serial number of the board; empty = the first one"},
      {"imu.baud_rate", &t.source.serial.baud, "Bd", {1200, 4'000'000}, "ignored by USB"},
      {"imu.silence_s", &t.silence, "s", {0.005, 1}, "without samples for so long the pose is carried on without them"},
      {"imu.latency_s", &d.clock.min_latency, "s", kLatency, "smallest delay from the measurement to its arrival"},
  };
}

Fields gnss_fields(GnssThreadConfig& t, NmeaParser::Config& d) {
  constexpr FieldRange kSigma{0.01, 100};
  return {
      {"gnss.device", &t.serial.path, "", kAnyText, "tty or pty of the GPS receiver; empty = there is none"},
      {"gnss.baud_rate", &t.serial.baud, "Bd", {1200, 4'000'000}, "ignored by USB"},
      {"gnss.latency_s", &d.clock.min_latency, "s", kLatency,
       "UTC of a fix to the arrival of its first byte, at least"},
      {"gnss.sigma_min_m", &d.noise.sigma_min_m, "m", kSigma, "of a strong fix"},
      {"gnss.sigma_max_m", &d.noise.sigma_max_m, "m", kSigma, "of a weak fix"},
      {"gnss.range_error_m", &d.noise.range_error_m, "m", kSigma, "sigma per unit of HDOP"},
      {"gnss.vertical_factor", &d.noise.vertical_factor, "", {1, 10}, "height against horizontal"},
  };
}

Fields wheel_fields(WheelThreadConfig& c) {
  return {
      {"wheel.device", &c.serial.path, "", kAnyText, "tty or pty of the wheels' board (drivers/wheel/README.md); empty = there is none"},
      {"wheel.baud_rate", &c.serial.baud, "Bd", {1200, 4'000'000}, "ignored by USB"},
      {"wheel.latency_s", &c.track.clock.min_latency, "s", kLatency, "smallest delay from a reading to its arrival"},
  };
}

Fields server_fields(ServerConfig& c) {
  return {
      {"server.socket", &c.socket_path, "", {1, 107}, "path of the Unix socket for clients"},
      {"server.save_dir", &c.save_dir, "", kSomeText, "folder that save_map writes into",
       kLive},
      {"server.control_group", &c.control_group, "", {0, 32}, "group whose members may save maps and inject faults; empty = every client"},
      {"server.max_clients", &c.limits.max_clients, "", {1, 4096}, "more are refused",
       kLive},
      {"server.max_request_bytes",
       &c.limits.max_request_bytes,
       "B",
       {1024, 1 << 24},
       "sender of a longer line is dropped",
       kLive},
      {"server.max_requests_per_s", &c.limits.max_requests_per_s, "1/s", {1, 1e6}, "of one client; more have to wait",
       kLive},
      {"server.max_outbound_bytes",
       &c.limits.max_outbound_bytes,
       "B",
       {4096, 1 << 28},
       "waiting for one client; then its notifications are lost",
       kLive},
      {"server.stall_timeout_s",
       &c.limits.stall_timeout_s,
       "s",
       {0.1, 3600},
       "a client that takes nothing for so long is dropped",
       kLive},
      {"server.max_jobs", &c.limits.max_jobs, "", {1, 1000}, "maps and files being made or waiting for it"},
  };
}

Fields patience_fields(SensorPatience& p, const std::string& sensor) {
  const std::string section = "health." + sensor + ".";
  constexpr FieldRange kSeconds{0.05, 3600};
  return {
      {section + "late_s", &p.late_s, "s", kSeconds, "without a good item for so long the sensor is degraded"},
      {section + "least_rate_hz", &p.least_rate_hz, "Hz", {0, 1e5}, "likewise with fewer good items a second"},
      {section + "most_bad_share", &p.most_bad_share, "", {0, 1}, "likewise with more refused or lost"},
      {section + "faulty_s", &p.faulty_s, "s", kSeconds,
       "silent, refused or not believed for so long in sum: faulty; good times count a tenth against it"},
      {section + "clean_s", &p.clean_s, "s", kSeconds, "without any defect until a faulty sensor is healthy"},
      {section + "proving_s", &p.proving_s, "s", kSeconds, "likewise a starting or degraded one"},
  };
}

Fields health_fields(HealthConfig& c) {
  Fields fields = patience_fields(c.lidar, "lidar");
  append(fields, patience_fields(c.imu, "imu"));
  append(fields, patience_fields(c.gnss, "gnss"));
  append(fields, {{"health.allow_inject", &c.allow_inject, "", {},
                   "sensors may be failed on purpose (slamctl inject), for rehearsals; never in service"}});
  return fields;
}

Fields map_fields(MapStoreConfig& c) {
  return {
      {"map.voxel_size_m", &c.voxel_size_m, "m", {0.01, 10}, "finest detail that is kept of each keyframe"},
      {"map.byte_budget",
       &c.byte_budget,
       "B",
       {1 << 16, 1e12},
       "of all points; beyond it the oldest keyframes are forgotten"},
      {"map.shared_keyframes",
       &c.shared_keyframes,
       "",
       {1, 100'000},
       "a surface that one of so many keyframes before has is not stored again"},
      {"map.moving_keyframes",
       &c.moving.keyframes,
       "",
       {0, 1000},
       "later keyframes that are asked whether a point moved; 0 keeps moving objects"},
  };
}

Fields checkpoint_fields(CheckpointConfig& c) {
  return {
      {"checkpoint.folder", &c.folder, "", kAnyText,
       "where the map is kept over a restart; empty = systemd's state directory, without systemd it is not kept"},
      {"checkpoint.period_s", &c.period, "s", {1, 3600}, "between two that are written whole, while the map grows; its keyframes are added as they come"},
      {"checkpoint.byte_budget", &c.byte_budget, "B", {1 << 16, 1 << 28},
       "of the newest keyframes' points; older ones are not kept over a restart"},
  };
}

Fields flight_recorder_fields(FlightRecorderConfig& c) {
  return {
      {"flight_recorder.span_s", &c.span, "s", {0, 600}, "of the sensors' bytes kept in memory for a dump; 0 = none"},
      {"flight_recorder.byte_budget", &c.byte_budget, "B", {1 << 23, 1 << 30}, "of them; beyond it the oldest are forgotten"},
      {"flight_recorder.folder", &c.folder, "", kAnyText,
       "where dumps go; empty = dumps in systemd's state directory, without systemd there are none"},
      {"flight_recorder.max_dumps", &c.max_dumps, "", {0, 10'000}, "more are not written until old ones are taken away"},
  };
}

Fields recording_fields(RecordingConfig& c) {
  return {
      {"recording.folder", &c.folder, "", kAnyText,
       "where recordings go (slamctl record); empty = recordings in systemd's state directory, without systemd there are none"},
      {"recording.max_bytes", &c.max_bytes, "B", {1 << 20, 1e13}, "of one file; then it is closed"},
      {"recording.max_s", &c.max_length, "s", {1, 604'800}, "of one recording; then it is closed"},
  };
}

Fields estimator_thread_fields(EstimatorThreadConfig& c) {
  return {
      {"estimator.hold_back_s",
       &c.merge.hold_back,
       "s",
       {0, 0.1},
       "an event waits so long for an earlier one of another sensor"},
      {"estimator.silence_s", &c.merge.silence, "s", {0.01, 1}, "after so long without events deadlines are checked"},
      {"estimator.late_s", &c.budget.late, "s", {0.01, 10}, "an estimator that is later works on fewer points of a scan"},
      {"estimator.hopeless_s", &c.budget.hopeless, "s", {0.02, 10}, "and lets it go when it is later than this: the next one is fresher"},
      {"estimator.poll_period_s", &c.poll_period, "s", {1e-4, 0.02}, "between two looks at empty rings"},
  };
}

Fields log_fields(LogConfig& c) {
  return {
      {"log.queue_lines", &c.queue_lines, "", {16, 1e6}, "waiting to be written; beyond it the oldest are lost"},
      {"log.repeat_period_s",
       &c.repeat_period,
       "s",
       {0, 3600},
       "a subject that changes more often is told so often only",
       kLive},
  };
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
      {"real_time.cpu_latency_us",
       &c.cpu_latency_us,
       "us",
       {-1, 1e6},
       "processors idle no deeper than wakes up in this time (/dev/cpu_dma_latency); -1 = as the system likes"},
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

Fields drive_vehicle_fields(DriveVehicle& v) {
  Fields fields = vehicle_fields(v.geometry, "");
  fields.push_back({"lidar_vertical_offsets", &v.lidar_vertical_offsets, "", {}, "see lidar.vertical_offsets of slamd.yaml"});
  fields.push_back({"lidar_model", &v.lidar_model, "", kSomeText, "vlp16, airy, rplidar_a2 or laser_scan"});
  return fields;
}

Fields config_fields(Config& c) {
  Fields fields{{"mode", &c.mode, "", {4, 6}, "full = all sensors in space; planar = a level cut, wheels and IMU in the plane"}};
  append(fields, vehicle_fields(c.vehicle, "vehicle."));
  append(fields, lidar_fields(c.lidar, c.lidar_decoder));
  append(fields, imu_fields(c.imu, c.imu_frames));
  append(fields, gnss_fields(c.gnss, c.nmea));
  append(fields, wheel_fields(c.wheel));
  append(fields, odometry_fields(c.odometry));
  append(fields, estimator_thread_fields(c.estimator));
  append(fields, back_end_fields(c.back_end));
  append(fields, planar_fields(c.planar));
  append(fields, map_fields(c.map));
  append(fields, checkpoint_fields(c.checkpoint));
  append(fields, flight_recorder_fields(c.flight_recorder));
  append(fields, recording_fields(c.recording));
  append(fields, server_fields(c.server));
  append(fields, health_fields(c.health));
  append(fields, real_time_fields(c.real_time));
  append(fields, log_fields(c.log));
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
