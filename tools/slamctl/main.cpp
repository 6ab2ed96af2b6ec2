// slamctl: asks a running slamd for its status, pose, map and path. Reads the command line; commands.cpp does the work.

#include <CLI/CLI.hpp>
#include <iostream>

#include "daemon/server/protocol/protocol.hpp"
#include "tools/slamctl/commands.hpp"

namespace {

using namespace slamd::slamctl;
using slamd::client::ClientError;

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 the daemon refused, a file could not be written, or doctor found something wrong;\n"
    "2 bad command line;\n"
    "3 no daemon at the socket, or it hung up or did not answer in time; 4 (status only) the daemon is not TRACKING.\n"
    "Examples:\n"
    "  slamctl status --watch\n"
    "  slamctl doctor\n"
    "  slamctl pose --follow --rate 50 --json\n"
    "  slamctl top --once\n"
    "  slamctl inject imu stuck --for 5\n"
    "  slamctl dump --out before-the-workshop\n"
    "  slamctl record start morning.mcap --max-s 600\n"
    "  slamctl map save campus.pcd --voxel 0.1 --box -50 -50 -5 50 50 20\n"
    "  slamctl grid --out house.pgm\n"
    "  slamctl trajectory save drive.tum";

using Command = int (*)(slamd::client::Connection&, const Options&);

void add_map(CLI::App& cli, Options& options) {
  CLI::App* map = cli.add_subcommand("map", "the 3D map")->require_subcommand(1);
  CLI::App* save = map->add_subcommand("save", "write the map into a file here");
  const auto extension = [](const std::string& name) {
    return name.ends_with(".pcd") || name.ends_with(".ply") ? std::string{} : "must end in .pcd or .ply";
  };
  save->add_option("FILE", options.file, "what to write: FILE.pcd or FILE.ply")->required()->check(extension);
  save->add_option("--voxel", options.voxel_size_m, "at most one point in each voxel of so many metres")
      ->check(CLI::Range(0.01, 100.0))->capture_default_str();
  save->add_option("--box", options.box, "only inside: min x y z max x y z, metres in map")->expected(6);
}

void add_record(CLI::App& cli, Options& options) {
  CLI::App* record = cli.add_subcommand("record", "have the daemon record its sensors as MCAP, for slam-replay, Foxglove and ROS 2")->require_subcommand(1);
  CLI::App* start = record->add_subcommand("start", "until stop, a limit, or the daemon's end");
  const auto extension = [](const std::string& name) { return name.ends_with(".mcap") ? std::string{} : "must end in .mcap"; };
  start->add_option("FILE", options.file, "name of the file among the daemon's recordings: FILE.mcap")->required()->check(extension);
  start->add_option("--max-s", options.max_s, "seconds; 0: recording.max_s of the configuration, never more")->check(CLI::Range(0.0, 604'800.0));
  start->add_option("--max-mb", options.max_mb, "megabytes; 0: recording.max_bytes of the configuration, never more")->check(CLI::Range(0.0, 1e7));
  record->add_subcommand("stop", "close the file");
  for (CLI::App* sub : record->get_subcommands({})) sub->fallthrough();
}

void add_grid(CLI::App& cli, Options& options) {
  CLI::App* grid = cli.add_subcommand("grid", "write the occupancy grid of planar mode here, as map_server reads it");
  const auto extension = [](const std::string& name) { return name.ends_with(".pgm") ? std::string{} : "must end in .pgm"; };
  options.file = "map.pgm";
  grid->add_option("--out", options.file, "the picture; its YAML comes beside it")->check(extension)->capture_default_str();
}

void add_status(CLI::App& cli, Options& options) {
  CLI::App* status = cli.add_subcommand("status", "how the daemon and its sensors are");
  status->add_flag("--watch", options.watch, "again and again, until interrupted");
  status->add_option("--interval", options.interval_s, "with --watch: seconds between two looks")
      ->check(CLI::Range(0.2, 60.0))->capture_default_str();
  status->add_option("--count", options.count, "with --watch: stop after so many");
}

void add_top(CLI::App& cli, Options& options) {
  CLI::App* top = cli.add_subcommand("top", "rates, latencies, gates, sensors, threads and memory, until interrupted");
  top->add_flag("--once", options.once, "one look, then end");
  top->add_option("--interval", options.interval_s, "seconds between two looks")
      ->check(CLI::Range(0.2, 60.0))->capture_default_str();
}

void add_inject(CLI::App& cli, Options& options) {
  CLI::App* inject = cli.add_subcommand("inject", "fail a sensor on purpose, where health.allow_inject permits it");
  inject->add_option("SENSOR", options.sensor, "which")->required()->check(CLI::IsMember({"lidar", "imu", "gps"}));
  inject->add_option("VERB", options.verb, "how; none ends it")->required()
      ->check(CLI::IsMember({"none", "off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent"}));
  inject->add_option("--for", options.for_s, "seconds until it ends by itself")
      ->check(CLI::Range(0.1, 600.0))->capture_default_str();
}

void add_commands(CLI::App& cli, Options& options) {
  cli.add_option("--socket", options.socket_path, "the daemon's socket")->capture_default_str()->envname("SLAMD_SOCKET");
  cli.add_flag("--json", options.json, "one JSON object a line instead of text");
  cli.add_option("--timeout", options.timeout_s, "seconds to wait for an answer")
      ->check(CLI::Range(0.1, 3600.0))->capture_default_str();
  cli.require_subcommand(1)->fallthrough()->footer(kFooter);
  add_status(cli, options);
  cli.add_subcommand("metrics", "status as Prometheus text, for the textfile collector of node_exporter");
  CLI::App* pose = cli.add_subcommand("pose", "where the vehicle is");
  pose->add_flag("--follow", options.follow, "every new pose, until interrupted");
  pose->add_option("--rate", options.rate_hz, "with --follow: poses a second")
      ->check(CLI::Range(0.01, 1000.0))->capture_default_str();
  pose->add_option("--count", options.count, "with --follow: stop after so many");
  cli.add_subcommand("doctor", "what is wrong with machine and daemon, and how to mend it; also when no daemon runs")
      ->add_option("--lidar", options.lidar_address, "the LiDAR's IPv4 address, to find its network port")
      ->check(CLI::ValidIPV4)->capture_default_str();
  add_top(cli, options);
  add_inject(cli, options);
  add_map(cli, options);
  add_grid(cli, options);
  add_record(cli, options);
  CLI::App* trajectory = cli.add_subcommand("trajectory", "the path driven so far")->require_subcommand(1);
  trajectory->add_subcommand("save", "write it as TUM text (base in odom)")
      ->add_option("FILE", options.file, "what to write")->required();
  cli.add_subcommand("dump", "have the daemon write the newest raw input of its sensors as a drive folder, for slam-replay")
      ->add_option("--out", options.file, "name of the folder among the daemon's dumps");
  for (CLI::App* sub : cli.get_subcommands({})) sub->fallthrough();
  for (CLI::App* sub : {cli.get_subcommand("map"), trajectory}) sub->get_subcommand("save")->fallthrough();
}

Command chosen(const CLI::App& cli) {
  if (cli.got_subcommand("status")) return show_status;
  if (cli.got_subcommand("metrics")) return show_metrics;
  if (cli.got_subcommand("pose")) return show_pose;
  if (cli.got_subcommand("top")) return show_top;
  if (cli.got_subcommand("inject")) return inject;
  if (cli.got_subcommand("dump")) return dump;
  if (cli.got_subcommand("record")) return cli.get_subcommand("record")->got_subcommand("start") ? start_recording : stop_recording;
  if (cli.got_subcommand("grid")) return save_grid;
  return cli.got_subcommand("map") ? save_map : save_trajectory;
}

int exit_code(const ClientError& error) {
  const bool gone = error.code() == ClientError::kNoConnection || error.code() == ClientError::kTimeout;
  return gone ? kNoDaemon : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.socket_path = slamd::protocol::kDefaultSocketPath;
  CLI::App cli{"slamctl: status, pose, map and path of a running slamd"};
  add_commands(cli, options);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli.exit(error) == 0 ? kOk : kUsage;
  }
  try {
    if (cli.got_subcommand("doctor")) return show_doctor(options);
    slamd::client::Connection daemon = connect(options);
    return chosen(cli)(daemon, options);
  } catch (const ClientError& error) {
    std::cerr << "slamctl: " << error.what() << '\n';
    return exit_code(error);
  } catch (const std::exception& error) {
    std::cerr << "slamctl: " << error.what() << '\n';
    return kFailed;
  }
}
