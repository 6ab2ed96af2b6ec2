// slam-replay: a recorded drive through slamd's estimator.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "daemon/config/config.hpp"
#include "daemon/store/cloud_file.hpp"
#include "tools/slam-replay/back_end_output.hpp"
#include "tools/slam-replay/drive/carmen_log.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"
#include "tools/slam-replay/injected_loops.hpp"
#include "tools/slam-replay/planar_replay.hpp"
#include "tools/slam-replay/replay.hpp"

namespace {

using namespace slamd;

enum ExitCode { kOk = 0, kBadDrive = 1, kBadConfig = 2, kCannotWrite = 3 };

struct Options {
  std::string drive, config, out;
  std::vector<std::string> overrides;
  double wrong_candidates = 0.0;
  bool no_gps = false, no_loops = false, no_map = false, quiet = false;
};

bool tell(const ConfigFaults& faults) {
  for (const std::string& fault : faults) std::fprintf(stderr, "slam-replay: %s\n", fault.c_str());
  return !faults.empty();
}

replay::DriverConfigs driver_configs(const Config& config) {
  replay::DriverConfigs drivers;
  drivers.vlp16 = config.vlp16;
  drivers.imu_clock.min_latency = config.imu_frames.clock.min_latency;
  drivers.imu_frames = config.imu_frames;
  drivers.nmea = config.nmea;
  drivers.lidar_port = config.lidar.port;
  return drivers;
}

bool write_text(const std::string& text, const std::string& path) {
  const Result<UniqueFd> file = text_memfd(text);
  return file && save_atomically(file->get(), path);
}

bool write_map(replay::Replay& replay, const std::string& path, std::uint64_t& points) {
  const MapSnapshot snapshot = replay.map().snapshot({});
  points = snapshot.size();
  if (snapshot.size() == 0) return true;
  const Result<UniqueFd> file = cloud_memfd(source_of(snapshot), {.format = CloudFormat::kPcd, .reference = snapshot.reference, .progress = {}});
  return file && save_atomically(file->get(), path);
}

/// As make_mapper of the back end; with a share of wrong candidates in the search for loops.
Mapper make_mapper(const BackEndConfig& config, const VehicleGeometry& vehicle, double wrong_candidates) {
  if (wrong_candidates == 0.0 || !config.use_loops) return slamd::make_mapper(config, vehicle);
  std::unique_ptr<PositionSource> positions;
  if (config.use_gps) positions = std::make_unique<GnssAlignment>(config.gps, vehicle.p_base_antenna);
  LoopCloser closer{config.loops, vehicle.T_base_lidar.translation};
  return Mapper{config.mapper, std::make_unique<replay::InjectedLoops>(std::move(closer), wrong_candidates),
                std::move(positions)};
}

/// The first bad line of every table of the drive.
void tell_bad_lines(const replay::Sensors& sensors) {
  const auto tell = [](const auto& stream) {
    if (!stream) return;
    const std::string complaint = stream->report().complaint;
    if (!complaint.empty()) std::fprintf(stderr, "slam-replay: %s\n", complaint.c_str());
  };
  tell(sensors.gnss);
  tell(sensors.wheel);
  tell(sensors.laser);
}

/// A CARMEN log brings its vehicle along: a laser that looks forwards, level, somewhere on its axis.
replay::Sensors open_carmen_log(const Options& options, Config& config) {
  replay::CarmenLog log = replay::read_carmen_log(options.drive);
  for (const std::string& fault : log.faults) std::fprintf(stderr, "slam-replay: %s\n", fault.c_str());
  config.mode = "planar";
  config.vehicle.T_base_lidar = {Eigen::Quaterniond::Identity(), {log.laser_forward_m, 0.0, 0.0}};
  return replay::sensors_of(std::move(log));
}

int run_planar(const Options& options, const Config& config, replay::Sensors sensors) {
  replay::Drive drive{std::move(sensors), config.estimator.merge};
  replay::PlanarReplay replay{config.vehicle, config.planar, config.odometry.scans.assembler};
  Progress progress{"replay", 1.0, options.quiet, ""};
  replay.run(drive, progress);
  if (!replay.write(drive.sensors(), options.out)) {
    std::fprintf(stderr, "slam-replay: %s: cannot write there (permission? disk full?)\n", options.out.c_str());
    return kCannotWrite;
  }
  progress.finish(std::to_string(replay.report().scans) + " scans, written to " + options.out);
  return kOk;
}

int run(const Options& options) {
  const std::string recorded_config = options.drive + "/slamd.yaml";
  const bool take_recorded = options.config.empty() && std::filesystem::exists(recorded_config);
  Loaded<Config> config = load_config(take_recorded ? recorded_config : options.config, options.overrides);
  if (tell(config.faults)) return kBadConfig;
  const std::string vehicle_path = options.drive + "/vehicle.yaml";
  if (std::filesystem::exists(vehicle_path)) {
    const Loaded<DriveVehicle> vehicle = load_drive_vehicle(vehicle_path);
    if (tell(vehicle.faults)) return kBadConfig;
    config.value.vehicle = vehicle.value.geometry;
    config.value.vlp16.vertical_offsets = vehicle.value.lidar_vertical_offsets;
  }
  replay::Sensors sensors = replay::is_carmen_name(options.drive)
                                ? open_carmen_log(options, config.value)
                                : replay::open_drive_folder(options.drive, driver_configs(config.value));
  if (options.no_gps) sensors.gnss.reset();
  if (!sensors.lidar && !sensors.imu && !sensors.laser) {
    std::fprintf(stderr, "slam-replay: %s: no lidar.pcap, imu.csv or imu.pcap that can be read there\n",
                 options.drive.c_str());
    return kBadDrive;
  }
  if (config.value.mode == "planar") return run_planar(options, config.value, std::move(sensors));
  replay::Drive drive{std::move(sensors), config.value.estimator.merge};
  replay::Output output{options.out};
  BackEndConfig& back_end = config.value.back_end;
  back_end.use_loops = back_end.use_loops && !options.no_loops;
  const VehicleGeometry& vehicle = config.value.vehicle;
  Relocaliser relocaliser{back_end.relocaliser, [&] { return make_mapper(back_end, vehicle, options.wrong_candidates); },
                          vehicle.T_base_lidar.translation};
  replay::Replay replay{vehicle, config.value.odometry, config.value.map, std::move(relocaliser)};
  Progress progress{"replay", 1.0, options.quiet, ""};
  replay.run(drive, output, progress, !options.no_map);
  replay::Report report = replay.report();
  const bool written = output.finish() && (options.no_map || replay::write_back_end(replay, options.out)) &&
                       write_map(replay, output.path("map.pcd"), report.map_points) &&
                       write_text(to_json(report, replay.times(), drive.sensors(), replay.stats()), output.path("report.json"));
  if (!written) {
    std::fprintf(stderr, "slam-replay: %s: cannot write there (permission? disk full?)\n", options.out.c_str());
    return kCannotWrite;
  }
  progress.finish(std::to_string(report.scans) + " scans, " + std::to_string(report.map_points) +
                  " map points, written to " + options.out);
  tell_bad_lines(drive.sensors());
  if (report.scans == 0) {
    std::fprintf(stderr, "slam-replay: %s: no pose came out of it: no LiDAR, or less than a second of it (report.json has the counts)\n",
                 options.drive.c_str());
  }
  return kOk;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Runs a recorded drive through slamd's estimator as fast as possible.\n"
               "Writes odom.tum and map.tum (one pose a scan), imu_rate.tum, covariance.csv, closures.csv, map.pcd, report.json."};
  app.add_option("DRIVE", options.drive, "drive folder: lidar.pcap, imu.csv, gps.csv, vehicle.yaml; a recording of slamd; or a CARMEN log (.clf, .log, .gz)")->required();
  app.add_option("--config", options.config, "slamd.yaml; without it the recording's own, else the defaults");
  app.add_option("--out", options.out, "folder for the results, made when missing")->required();
  app.add_option("--set", options.overrides, "key=value over the configuration, may be repeated");
  app.add_flag("--no-gps", options.no_gps, "leave gps.csv unread");
  app.add_flag("--no-loops", options.no_loops, "no loop closure");
  app.add_option("--wrong-candidates", options.wrong_candidates,
                 "test of the loop closer: this share of the places looked at also gets a candidate that is none")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--no-map", options.no_map, "no back end and no map: no map.tum, no map.pcd, and the memory is the front end's alone");
  app.add_flag("--quiet", options.quiet, "no progress bar");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
