#include "tools/slam-sim/program/options.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <numbers>
#include <sstream>

#include "tools/slam-sim/motion/euler.hpp"
#include "tools/slam-sim/output/scenarios.hpp"

namespace slamd::sim {
namespace {

const std::map<std::string, WorldKind> kWorlds{{"campus", WorldKind::kCampus},
                                               {"corridor", WorldKind::kCorridor},
                                               {"grounds", WorldKind::kGrounds},
                                               {"hills", WorldKind::kHills},
                                               {"house", WorldKind::kHouse},
                                               {"parking", WorldKind::kParking},
                                               {"open-field", WorldKind::kOpenField},
                                               {"urban", WorldKind::kUrban}};
const std::map<std::string, CourseKind> kCourses{{"loop", CourseKind::kLoop},
                                                 {"two-laps", CourseKind::kTwoLaps},
                                                 {"figure-eight", CourseKind::kFigureEight},
                                                 {"line-and-back", CourseKind::kLineAndBack},
                                                 {"standstill", CourseKind::kStandstill}};
const std::map<std::string, ReturnMode> kReturns{
    {"strongest", ReturnMode::kStrongest}, {"last", ReturnMode::kLast}, {"dual", ReturnMode::kDual}};

const std::map<std::string, LidarKind> kLidars{{"vlp16", LidarKind::kVlp16}, {"airy", LidarKind::kAiry},
                                               {"rplidar_a2", LidarKind::kRplidarA2}, {"laser_scan", LidarKind::kLaserScan}};

const std::map<std::string, RplidarFirmware> kFirmwares{
    {"standard", RplidarFirmware::kStandard}, {"express", RplidarFirmware::kExpress}, {"boost", RplidarFirmware::kBoost}};

template <class Enum>
void add_choice(CLI::App& app, const char* name, const std::map<std::string, Enum>& words, Enum& target,
                const char* text) {
  app.add_option_function<std::string>(
         name, [&words, &target](const std::string& word) { target = words.at(word); }, text)
      ->check(CLI::IsMember(words));
}

std::string scenario_help() {
  std::string text = "Scenarios:\n";
  for (const Scenario& s : scenarios())
    text += "  " + std::string(s.name) + std::string(16 - std::string(s.name).size(), ' ') + s.meaning + "\n";
  return text + "\nFaults (--fault, repeatable):\n  " + kFaultGrammar + "\n";
}

/// Must come first: callbacks run in the order of definition, so that every other option overrides the preset.
void add_scenario(CLI::App& app, Options& o) {
  std::vector<std::string> names;
  for (const Scenario& scenario : scenarios()) names.emplace_back(scenario.name);
  app.add_option_function<std::string>(
         "--scenario",
         [&o](const std::string& name) {
           o.scenario = name;
           find_scenario(name)->apply(o.drive);
         },
         "preset of world, course and disturbances; the options below change it (default: campus)")
      ->check(CLI::IsMember(names));
}

void add_drive(CLI::App& app, DriveSpec& d) {
  app.add_option("--seed", d.seed, "of world, motion and noise")->capture_default_str()->group("Drive");
  add_choice(app, "--world", kWorlds, d.world, "where to drive");
  add_choice(app, "--trajectory", kCourses, d.course.kind, "which way");
  app.add_option("--laps", d.course.laps, "so many times a closed way")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--duration", d.max_duration_s, "end after this many seconds (0 = when the course ends)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--length", d.course.length_m, "end the course after this many metres (0 = all of it)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--speed", d.course.limits.speed_mps, "highest speed, m/s (0 = the world's limit)")
      ->check(CLI::Range(0.0, 30.0));
  app.add_option("--rest", d.course.rest_s, "standstill at the start, s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--stop-every", d.course.stop_every_m, "a stop after so many metres, again and again (0 = none)")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--moving-start", d.course.moving_start, "no standstill: begin at full speed");
  app.add_option("--crowd", d.crowd, "number of moving cars and pedestrians")->check(CLI::Range(0, 500));
  app.add_option("--threads", d.threads, "0 = one per core; the bytes do not depend on it")->check(CLI::Range(0, 64));
  app.add_option_function<std::vector<std::string>>(
         "--fault",
         [&d](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const auto parsed = parse_fault(text);
             if (const auto* complaint = std::get_if<std::string>(&parsed))
               throw CLI::ValidationError("--fault", *complaint);
             d.faults.push_back(std::get<Fault>(parsed));
           }
         },
         "what goes wrong, when (see below)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_driving(CLI::App& app, CourseSpec& course) {
  app.add_option("--acceleration", course.limits.acceleration_mps2, "highest, m/s^2")->check(CLI::Range(0.1, 10.0));
  app.add_option("--braking", course.limits.braking_mps2, "hardest, m/s^2")->check(CLI::Range(0.1, 10.0));
  app.add_option("--lateral", course.limits.lateral_mps2, "highest in bends, m/s^2")->check(CLI::Range(0.1, 10.0));
  app.add_option("--slalom", course.slalom_m, "swerving about the path, amplitude, m")->check(CLI::Range(0.0, 3.0));
  app.add_option("--bumps", course.wobble.bumps_per_m, "speed bumps and holes a metre of way")->check(CLI::Range(0.0, 1.0));
  app.add_option_function<double>(
         "--roughness",
         [&course](double factor) {
           for (double* part : {&course.wobble.heave_m, &course.wobble.roll_rad, &course.wobble.pitch_rad, &course.wobble.yaw_rad})
             *part *= factor;
         },
         "the suspension moves so many times as much")
      ->check(CLI::Range(0.0, 10.0));
}

/// x, y, z in metres, roll, pitch, yaw in degrees.
Pose mounted(const std::array<double, 6>& at) {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  return {from_roll_pitch_yaw(Eigen::Vector3d(at[3], at[4], at[5]) * kRadPerDeg), {at[0], at[1], at[2]}};
}

void add_mounting(CLI::App& app, Mounting& mounting) {
  const auto place = [&](const char* name, Pose& pose, const char* text) {
    app.add_option_function<std::array<double, 6>>(name, [&pose](const auto& at) { pose = mounted(at); }, text);
  };
  const auto tilt = [&](const char* name, Eigen::Vector3d& angles_rad, const char* text) {
    app.add_option_function<std::array<double, 3>>(
        name, [&angles_rad](const auto& deg) { angles_rad = Eigen::Vector3d(deg[0], deg[1], deg[2]) * (std::numbers::pi / 180.0); }, text);
  };
  place("--lidar-mount", mounting.told.T_base_lidar, "T_base_lidar: x y z (m) roll pitch yaw (degrees)");
  place("--imu-mount", mounting.told.T_base_imu, "T_base_imu, likewise");
  app.add_option_function<std::array<double, 3>>(
      "--antenna", [&mounting](const auto& at) { mounting.told.p_base_antenna = Eigen::Vector3d(at.data()); }, "p_base_antenna: x y z (m)");
  tilt("--lidar-tilt", mounting.lidar_tilt_rad, "roll pitch yaw (degrees) that vehicle.yaml does not know of");
  tilt("--imu-tilt", mounting.imu_tilt_rad, "likewise of the IMU");
}

void add_lidar(CLI::App& app, DriveSpec& d) {
  add_choice(app, "--lidar", kLidars, d.lidar_kind, "which one: a VLP-16, a RoboSense Airy, an RPLIDAR A2, or an LDS-01 that gives finished scans (default: by the scenario)");
  app.add_flag_callback(
      "--no-lidar", [&d] { d.with_lidar = false; }, "switched off");
  app.add_option("--rpm", d.lidar.rpm, "revolutions per minute")
      ->check(CLI::Range(300.0, 1200.0))
      ->capture_default_str();
  add_choice(app, "--a2-firmware", kFirmwares, d.rplidar, "of an RPLIDAR A2: the scan that it knows best (default: boost)");
  add_choice(app, "--returns", kReturns, d.lidar.mode, "which echoes (default: strongest)");
  app.add_option("--range-noise", d.lidar.range_noise_m, "standard deviation, m")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--laser-bias", d.lidar.laser_bias_m, "constant range error of each laser, standard deviation, m")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--mixed-pixels", d.lidar.mixed_pixels, "beams have a width and split at edges");
  app.add_option("--reach", d.lidar.reach, "in proportion to a clean sensor's in clear air")->check(CLI::Range(0.05, 2.0));
  app.add_option("--clutter", d.lidar.clutter, "share of firings that rain or dust returns")->check(CLI::Range(0.0, 1.0));
  app.add_option_function<std::array<double, 2>>(
      "--blind",
      [&d](const auto& sector) {
        d.lidar.blind_from_deg = sector[0];
        d.lidar.blind_to_deg = sector[1];
      },
      "no returns between these azimuths, degrees clockwise from the front, 0..360");
  app.add_option("--lidar-skew", d.lidar.clock_skew_ppm, "of its clock, ppm")->capture_default_str();
  app.add_flag("--lidar-pps", d.lidar.pps_locked, "its clock follows UTC; position packets carry $GPRMC");
}

void add_planar_lidar(CLI::App& app, DriveSpec& d) {
  PlanarLidarModel& model = d.planar_lidar;
  app.add_option("--scan-beams", model.beams, "a revolution")->check(CLI::Range(8, 10000))->capture_default_str();
  app.add_option("--scan-rate", model.rate_hz, "Hz")->check(CLI::Range(0.5, 50.0))->capture_default_str();
  app.add_option("--scan-reach", model.max_range_m, "m")->check(CLI::Range(0.5, 100.0))->capture_default_str();
  app.add_option("--scan-noise", model.range_noise_m, "standard deviation, m")->check(CLI::Range(0.0, 1.0))->capture_default_str();
}

void add_wheel(CLI::App& app, DriveSpec& d) {
  app.add_flag("--wheel,!--no-wheel", d.with_wheel, "the vehicle has wheel odometry");
  WheelModel& model = d.wheel;
  app.add_option("--wheel-rate", model.rate_hz, "Hz")->check(CLI::Range(1.0, 1000.0))->capture_default_str();
  app.add_option("--wheel-slip", model.slip_m_rtm, "of each wheel, m per root metre")->check(CLI::NonNegativeNumber)->capture_default_str();
  app.add_option("--wheel-scale", model.scale_percent, "error of the wheels' size, standard deviation, percent")->check(CLI::Range(0.0, 20.0));
  app.add_option("--wheel-balance", model.balance_percent, "of one wheel's size against the other's, likewise")->check(CLI::Range(0.0, 20.0));
  app.add_option("--wheel-track", model.track_percent, "of the track as told, likewise")->check(CLI::Range(0.0, 20.0));
}

void add_imu(CLI::App& app, DriveSpec& d) {
  app.add_flag_callback(
      "--no-imu", [&d] { d.with_imu = false; }, "switched off");
  app.add_option("--imu-rate", d.imu.rate_hz, "Hz")->check(CLI::Range(10.0, 2000.0))->capture_default_str();
  app.add_option("--gyro-noise", d.imu.gyro_noise_mdps_rthz, "mdps/rtHz")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--accel-noise", d.imu.accel_noise_ug_rthz, "ug/rtHz")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--gyro-bias", d.imu.gyro_bias_dps, "turn-on, standard deviation, deg/s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--accel-bias", d.imu.accel_bias_mg, "turn-on, standard deviation, mg")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--gyro-walk", d.imu.gyro_walk_mdps_rts, "of its bias, mdps/rts")->check(CLI::NonNegativeNumber);
  app.add_option("--accel-walk", d.imu.accel_walk_ug_rts, "of its bias, ug/rts")->check(CLI::NonNegativeNumber);
  app.add_option("--gyro-scale", d.imu.gyro_scale_percent, "error of scale, standard deviation, percent")
      ->check(CLI::Range(0.0, 20.0));
  app.add_option("--engine", d.imu.engine_mps2, "shaking of an engine that runs, at rest too, m/s^2")->check(CLI::Range(0.0, 20.0));
  app.add_option("--imu-skew", d.imu.clock_skew_ppm, "of its clock, ppm")->capture_default_str();
  app.add_option("--gravity", d.imu.gravity_mps2, "m/s^2")->check(CLI::Range(9.0, 10.5))->capture_default_str();
  app.add_flag("--ideal-imu", d.imu.ideal, "no noise and no bias (still quantised)");
}

/// For CLI11: what is wrong with a list of sentences, or nothing.
std::string known_sentences(const std::string& list) {
  std::istringstream kinds{list};
  for (std::string kind; std::getline(kinds, kind, ',');) {
    if (!is_sentence(kind)) return "\"" + kind + "\" is no sentence (GGA RMC GSA GST VTG ZDA)";
  }
  return {};
}

void add_gps(CLI::App& app, DriveSpec& d) {
  app.add_flag_callback(
      "--no-gps", [&d] { d.with_gps = false; }, "switched off");
  app.add_option_function<std::array<double, 3>>(
      "--gps-origin",
      [&d](const std::array<double, 3>& place) {
        d.gps.latitude_deg = place[0];
        d.gps.longitude_deg = place[1];
        d.gps.altitude_m = place[2];
      },
      "latitude, longitude (degrees) and ellipsoidal height (m) of the world's origin");
  app.add_option("--geoid", d.gps.geoid_separation_m, "height of the geoid above the ellipsoid, m")
      ->capture_default_str();
  app.add_option("--gps-rate", d.gps.rate_hz, "Hz")->check(CLI::Range(0.1, 20.0))->capture_default_str();
  app.add_option("--gps-sigma", d.gps.correlated_m, "slow horizontal error, standard deviation, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--gps-correlation", d.gps.correlation_s, "the slow error lasts for so long, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--gps-white", d.gps.white_m, "horizontal error of each fix by itself, standard deviation, m")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--gps-hdop", d.gps.hdop, "that it claims, whatever its error")->check(CLI::Range(0.5, 50.0))->capture_default_str();
  app.add_option("--gps-latency", d.gps.latency_s, "s")->check(CLI::Range(0.0, 5.0))->capture_default_str();
  app.add_option("--gps-sentences", d.gps.sentences, "of GGA RMC GSA GST VTG ZDA, separated by commas")
      ->check(known_sentences)
      ->capture_default_str();
  app.add_option("--utc-start", d.gps.utc_start_s, "UTC of the start, seconds since 1970")->capture_default_str();
}

void add_output(CLI::App& app, Options& o) {
  auto* out = app.add_option("--out", o.out, "write this drive folder, as fast as possible");
  auto* live = app.add_flag("--live", o.live, "send in real time: UDP and pseudo terminals");
  out->excludes(live);
  app.add_option("--host-start", o.host_start_s, "host time of the start in the drive folder, s")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("--serial-bytes", o.serial_bytes, "in the folder imu.pcap and gps.pcap, the bytes of the ports, in place of tables")
      ->needs(out);
  app.add_flag("--quiet", o.quiet, "no progress");
  LiveOptions& l = o.live_options;
  app.add_option("--udp-host", l.udp_host, "IPv4 address the LiDAR's packets go to")
      ->needs(live)
      ->capture_default_str();
  app.add_option("--lidar-port", l.ports.points, "of data packets (default: the LiDAR's own)")->needs(live);
  app.add_option("--position-port", l.ports.side, "of position or device packets, likewise")->needs(live);
  app.add_option("--lidar-imu-port", l.ports.imu, "of an Airy's IMU, likewise")->needs(live);
  app.add_option("--lidar-pty", l.lidar_pty, "symlink to make: the serial port of an RPLIDAR A2, which answers commands")->needs(live);
  app.add_option("--imu-pty", l.imu_pty, "symlink to make: the IMU's serial port")->needs(live);
  app.add_option("--gps-pty", l.gps_pty, "symlink to make: the receiver's serial port")->needs(live);
  app.add_option("--wheel-pty", l.wheel_pty, "symlink to make: the wheel odometry's serial port")->needs(live);
  app.add_option("--truth", l.truth, "write the exact poses there (TUM, CLOCK_MONOTONIC)")->needs(live);
  app.add_option("--imu-motion", l.imu_motion, "write the exact motion of the IMU there before the start (CSV, 1 kHz)")
      ->needs(live);
  app.add_option("--start-delay", l.start_delay_s, "between making the ports and the first byte, s")
      ->needs(live)
      ->check(CLI::Range(0.0, 60.0))
      ->capture_default_str();
}

/// Options added by `add` get the group's heading in --help.
template <class Add>
void grouped(CLI::App& app, const std::string& group, const Add& add) {
  app.option_defaults()->group(group);
  add();
}

}  // namespace

Parsed parse_command_line(int argc, char** argv) {
  Options o;
  CLI::App app{"slam-sim: simulated drives of a vehicle with VLP-16, IMU and GPS, as the bytes the sensors would send"};
  app.footer(scenario_help());
  add_scenario(app, o);
  grouped(app, "Drive", [&] { add_drive(app, o.drive); });
  grouped(app, "Driving", [&] { add_driving(app, o.drive.course); });
  grouped(app, "Mounting", [&] { add_mounting(app, o.drive.mounting); });
  grouped(app, "LiDAR", [&] { add_lidar(app, o.drive); });
  grouped(app, "2D LiDAR (LDS-01)", [&] { add_planar_lidar(app, o.drive); });
  grouped(app, "IMU (LSM6DSOX)", [&] { add_imu(app, o.drive); });
  grouped(app, "Wheel odometry", [&] { add_wheel(app, o.drive); });
  grouped(app, "GPS", [&] { add_gps(app, o.drive); });
  grouped(app, "Output", [&] { add_output(app, o); });
  try {
    app.parse(argc, argv);
    if (o.out.empty() && !o.live) throw CLI::RequiredError("--out FOLDER or --live");
    if (o.live && o.drive.lidar_kind == LidarKind::kLaserScan)
      throw CLI::ValidationError("--live", "the 2D LiDAR of this drive has no wire that slamd reads; take --out FOLDER or --lidar vlp16");
  } catch (const CLI::ParseError& error) {
    return {std::nullopt, app.exit(error)};
  }
  return {o, 0};
}

}  // namespace slamd::sim
