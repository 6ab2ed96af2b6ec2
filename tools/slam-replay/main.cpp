// slam-replay: a recorded drive through slamd's estimator.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <set>

#include "daemon/config/config.hpp"
#include "daemon/store/cloud_file.hpp"
#include "tools/slam-replay/back_end_output.hpp"
#include "tools/slam-replay/bag/own_recording.hpp"
#include "tools/slam-replay/injected_loops.hpp"
#include "tools/slam-replay/planar_replay.hpp"
#include "tools/slam-replay/recording.hpp"
#include "tools/slam-replay/replay.hpp"

namespace {

using namespace slamd;

enum ExitCode { kOk = 0, kBadDrive = 1, kBadConfig = 2, kCannotWrite = 3 };

struct Options {
  std::string drive, config, out;
  std::vector<std::string> overrides, topics;
  double wrong_candidates = 0.0;
  bool list = false, no_gps = false, no_loops = false, no_map = false, quiet = false;
};

bool tell(const ConfigFaults& faults) {
  for (const std::string& fault : faults) std::fprintf(stderr, "slam-replay: %s\n", fault.c_str());
  return !faults.empty();
}

replay::DriverConfigs driver_configs(const Config& config) {
  replay::DriverConfigs drivers;
  const LidarModel model = lidar_model(config.lidar.model).value_or(LidarModel::kVlp16);
  drivers.lidar = {model, {config.lidar.port, config.lidar.position_port, ports_of(model).imu}, config.lidar_decoder};
  drivers.airy_imu.clock.min_latency = config.imu_frames.clock.min_latency;
  drivers.imu_clock.min_latency = config.imu_frames.clock.min_latency;
  drivers.imu_frames = config.imu_frames;
  drivers.nmea = config.nmea;
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

/// "role=/topic" each.
replay::TopicWishes wishes(const Options& options) {
  replay::TopicWishes wishes;
  for (const std::string& wish : options.topics) {
    const std::size_t equals = std::min(wish.find('='), wish.size());
    wishes[wish.substr(0, equals)] = wish.substr(std::min(equals + 1, wish.size()));
  }
  return wishes;
}

int list(const Options& options) {
  std::string fault;
  const std::string text = replay::list_recording(options.drive, wishes(options), fault);
  if (!fault.empty()) std::fprintf(stderr, "slam-replay: %s\n", fault.c_str());
  else std::fputs(text.c_str(), stdout);
  return fault.empty() ? kOk : kBadDrive;
}

/// What the drive says of its vehicle; of a folder also of its LiDAR, whose ports are those as delivered when it is another one than
/// the configuration's.
void take_over(const DriveVehicle& drive, Config& config, bool is_drive_folder) {
  config.vehicle = drive.geometry;
  if (!is_drive_folder) return;
  config.lidar_decoder.vertical_offsets = drive.lidar_vertical_offsets;
  const std::optional<LidarModel> model = lidar_model(drive.lidar_model);
  if (!model || drive.lidar_model == config.lidar.model) return;
  config.lidar.model = drive.lidar_model;
  config.lidar.port = ports_of(*model).points;
  config.lidar.position_port = ports_of(*model).side;
}

/// Path of the recording's own configuration, empty when it has none; that of an MCAP file is put beside the results.
std::string own_config(const Options& options) {
  const std::string beside = options.drive + "/slamd.yaml";
  if (std::filesystem::is_directory(options.drive)) return std::filesystem::exists(beside) ? beside : "";
  const std::optional<std::string> text =
      replay::is_own_recording(options.drive) ? replay::recorded_config(options.drive) : std::nullopt;
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  const std::string copied = options.out + "/slamd.yaml";
  return text && write_text(*text, copied) ? copied : "";
}

/// The configuration as told, else the recording's own; then what vehicle.yaml beside the recording says.
Loaded<Config> configuration(const Options& options) {
  const bool is_folder = std::filesystem::is_directory(options.drive);
  Loaded<Config> config = load_config(options.config.empty() ? own_config(options) : options.config, options.overrides);
  if (!is_folder && replay::is_own_recording(options.drive)) return config;  // it says where its sensors were
  const std::string vehicle_path = replay::folder_of(options.drive) + "/vehicle.yaml";
  if (!config.faults.empty() || !std::filesystem::exists(vehicle_path)) return config;
  Loaded<DriveVehicle> vehicle = load_drive_vehicle(vehicle_path);
  config.faults = std::move(vehicle.faults);
  take_over(vehicle.value, config.value, is_folder && !replay::is_bag(options.drive));
  return config;
}

/// Of the sensors' streams, each first fault once.
void tell_faults(const replay::Sensors& sensors) {
  std::set<std::string> faults;
  const auto add = [&faults](const auto& stream) {
    if (stream && !stream->report().complaint.empty()) faults.insert(stream->report().complaint);
  };
  add(sensors.lidar);
  add(sensors.imu);
  add(sensors.gnss);
  add(sensors.wheel);
  add(sensors.laser);
  for (const std::string& fault : faults) {
    std::fprintf(stderr, "slam-replay: %s (what was whole has been used; report.json counts the rest)\n", fault.c_str());
  }
}

int run_planar(const Options& options, const Config& config, replay::Sensors sensors) {
  replay::Drive drive{std::move(sensors), config.estimator.merge};
  replay::PlanarReplay replay{config.vehicle, config.planar, config.odometry.scans.assembler};
  Progress progress{"replay", 1.0, options.quiet, ""};
  replay.run(drive, progress);
  tell_faults(drive.sensors());
  if (!replay.write(drive.sensors(), options.out)) {
    std::fprintf(stderr, "slam-replay: %s: cannot write there (permission? disk full?)\n", options.out.c_str());
    return kCannotWrite;
  }
  progress.finish(std::to_string(replay.report().scans) + " scans, written to " + options.out);
  return kOk;
}

int run(const Options& options) {
  Loaded<Config> config = configuration(options);
  if (tell(config.faults)) return kBadConfig;
  replay::Recording recording = replay::open_recording(options.drive, wishes(options), driver_configs(config.value));
  if (!recording.fault.empty()) {
    std::fprintf(stderr, "slam-replay: %s\n", recording.fault.c_str());
    return kBadDrive;
  }
  replay::Sensors sensors = std::move(recording.sensors);
  if (options.no_gps) sensors.gnss.reset();
  if (const std::string line = replay::missing_line(sensors); !line.empty()) recording.notes.push_back(line);
  for (const std::string& note : recording.notes) {
    if (!options.quiet) std::fprintf(stderr, "slam-replay: %s\n", note.c_str());
  }
  if (recording.T_base_lidar) config.value.vehicle.T_base_lidar = *recording.T_base_lidar;
  if (!sensors.lidar && sensors.laser) config.value.mode = "planar";
  config.value.planar.mapper.use_loops = config.value.planar.mapper.use_loops && !options.no_loops;
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
  tell_faults(drive.sensors());
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
  app.add_option("DRIVE", options.drive, "drive folder (lidar.pcap, imu.csv, gps.csv, vehicle.yaml; or a recording of slamd), ROS 1 bag, ROS 2 bag (.db3, folder),\n"
                 "MCAP file, CARMEN log (.clf, .log, .gz), or capture of the LiDAR (pcap)")->required();
  app.add_option("--config", options.config, "slamd.yaml; without it the recording's own, else the defaults");
  app.add_option("--out", options.out, "folder for the results, made when missing");
  app.add_flag("--list", options.list, "only say what is in DRIVE: topics, types, messages, what each is taken for");
  app.add_option("--topic", options.topics, "of a bag: lidar|imu|gps|odometry|scan=/topic, over the choice by type; without a topic: none")
      ->allow_extra_args(false);
  app.add_option("--set", options.overrides, "key=value over the configuration, may be repeated");
  app.add_flag("--no-gps", options.no_gps, "leave gps.csv unread");
  app.add_flag("--no-loops", options.no_loops, "no loop closure");
  app.add_option("--wrong-candidates", options.wrong_candidates,
                 "test of the loop closer: this share of the places looked at also gets a candidate that is none")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--no-map", options.no_map, "no back end and no map: no map.tum, no map.pcd, and the memory is the front end's alone");
  app.add_flag("--quiet", options.quiet, "no progress bar");
  CLI11_PARSE(app, argc, argv);
  if (options.list) return list(options);
  if (options.out.empty()) return app.exit(CLI::RequiredError("--out"));
  return run(options);
}
