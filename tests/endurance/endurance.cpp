// Hours of driving and standing, faster than real time: one simulated lap again and again, through wire bytes, with faults as the lap
// has them. Prints a line a simulated hour; ends with 1 when memory still grows at the end or the vehicle was lost for good.
//     slam-sim --world parking --seed 1 --rest 25 --lidar-skew 0 --imu-skew 0 --serial-bytes --fault lidar:gap@40+3 --out LAP
//     endurance LAP --hours 24

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "daemon/health/process_memory.hpp"
#include "tests/endurance/day.hpp"
#include "tests/endurance/lap.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"

namespace slamd::endurance {
namespace {

constexpr double kMegabyte = 1024.0 * 1024.0;
constexpr double kFlatMegabytes = 8.0;  // of growth in the second half
constexpr double kMostAway_m = 1.0;     // from where a lap began, at its end

/// Pipes in a folder of their own, which another process fills with the laps: so that its memory is none of ours.
class Feeder {
 public:
  Feeder(const std::string& lap_folder, const LapPlan& plan, Duration length) {
    std::string name = std::filesystem::temp_directory_path() / "slamd-endurance-XXXXXX";
    folder_ = ::mkdtemp(name.data());
    for (const char* wire : Lap::kWires) ::mkfifo((folder_ + '/' + wire).c_str(), 0600);
    child_ = ::fork();
    if (child_ != 0) return;
    feed({lap_folder, plan}, length);
    ::_exit(0);
  }
  ~Feeder() {
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }
  Feeder(const Feeder&) = delete;
  Feeder& operator=(const Feeder&) = delete;

  const std::string& folder() const { return folder_; }

 private:
  void feed(const Lap& lap, Duration length) const {
    std::vector<std::jthread> writers;
    for (std::size_t wire = 0; wire < Lap::kWires.size(); ++wire) {
      writers.emplace_back([&lap, wire, length, this] { lap.write(wire, length, folder_ + '/' + Lap::kWires[wire]); });
    }
  }

  std::string folder_;
  pid_t child_ = -1;
};

/// What is printed at the end of each hour, and what is judged at the end of all.
class Log {
 public:
  explicit Log(const LapPlan& plan) : plan_{plan} {
    std::puts("| hour | times real time | resident MB | map MB | graph MB | keyframes, left out | scans TRACKING, LOST | odom begun anew | "
              "LiDAR: lost, refused, clock jumps | IMU: lost, resets, clock jumps | fixes | away from the start: odom, map m |");
    std::puts("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
  }

  /// After every event.
  void look(const Day& day, const replay::Drive& drive) {
    if (begin_ == HostTime{}) begin_ = day.now();
    note_place(day);
    if (day.now() - begin_ < std::chrono::hours{static_cast<int>(memory_.size()) + 1}) return;
    memory_.push_back(static_cast<double>(process_memory().resident_bytes) / kMegabyte);
    print(day, drive);
    away_odom_m_ = away_map_m_ = 0.0;
  }

  bool is_good(const Day& day) const {
    const bool flat = memory_.size() < 4 || memory_.back() <= memory_[memory_.size() / 2] + kFlatMegabytes;
    if (!flat) std::puts("memory grew in the second half");
    const bool at_home = worst_m_ <= kMostAway_m;
    if (!at_home) std::puts("the vehicle was lost");
    return flat && at_home && day.counts().scans > 0;
  }

 private:
  /// A lap begins where the one before ended: how far from there the estimate is.
  void note_place(const Day& day) {
    const std::int64_t lap = (day.now() - begin_) / plan_.period;
    if (lap == lap_ || (day.now() - begin_) % plan_.period < std::chrono::seconds{2} || day.counts().scans == 0) return;
    if (lap_ < 0) p_odom_start_ = day.T_odom_base().translation, p_map_start_ = day.T_map_base().translation;
    lap_ = lap;
    away_odom_m_ = std::max(away_odom_m_, (day.T_odom_base().translation - p_odom_start_).norm());
    away_map_m_ = std::max(away_map_m_, (day.T_map_base().translation - p_map_start_).norm());
    worst_m_ = std::max(worst_m_, away_map_m_);
  }

  void print(const Day& day, const replay::Drive& drive) const {
    const DayCounts& counts = day.counts();
    const Mapper& mapper = day.back_end().mapper();
    const replay::StreamReport lidar = drive.sensors().lidar->report();
    const replay::StreamReport imu = drive.sensors().imu->report();
    const double simulated_s = to_seconds(day.now() - begin_);
    const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
    std::printf("| %zu | %.1f | %.1f | %.1f | %.1f | %llu, %llu | %.2f %%, %llu | %llu | %llu, %llu, %llu | %llu, %llu, %llu | %llu | %.3f, %.3f |\n",
                memory_.size(), simulated_s / wall_s, memory_.back(), static_cast<double>(day.map().bytes) / kMegabyte,
                static_cast<double>(mapper.bytes()) / kMegabyte, n(counts.keyframes), n(mapper.left_out_keyframes()),
                100.0 * static_cast<double>(counts.tracking) / static_cast<double>(std::max<std::uint64_t>(1, counts.scans)),
                n(counts.lost), n(day.odometry().resets), n(lidar.missing), n(lidar.refused()), n(lidar.clock_jumps), n(imu.missing),
                n(imu.resets), n(imu.clock_jumps), n(counts.fixes), away_odom_m_, away_map_m_);
    std::fflush(stdout);
  }

  LapPlan plan_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  HostTime begin_;
  std::vector<double> memory_;  // MB at the end of each hour
  std::int64_t lap_ = -1;
  Eigen::Vector3d p_odom_start_ = Eigen::Vector3d::Zero(), p_map_start_ = Eigen::Vector3d::Zero();
  double away_odom_m_ = 0.0, away_map_m_ = 0.0;  // worst of the hour
  double worst_m_ = 0.0;                         // in map
};

int run(const std::string& folder, double hours, const std::vector<std::string>& overrides) {
  const Result<LapPlan> plan = plan_lap(folder);
  Loaded<Config> config = load_config("", overrides);
  const Loaded<DriveVehicle> vehicle = load_drive_vehicle(folder + "/vehicle.yaml");
  for (const std::string& fault : config.faults) std::fprintf(stderr, "endurance: %s\n", fault.c_str());
  if (!plan || !config.faults.empty() || !vehicle.faults.empty()) {
    std::fprintf(stderr, "endurance: %s: %s\n", folder.c_str(), plan ? "bad configuration or vehicle.yaml" : plan.reason());
    return 2;
  }
  config.value.vehicle = vehicle.value.geometry;
  config.value.lidar_decoder.vertical_offsets = vehicle.value.lidar_vertical_offsets;
  const Feeder feeder{folder, *plan, from_seconds(3600.0 * hours)};
  replay::DriverConfigs wires;
  wires.lidar.decoder = config.value.lidar_decoder;
  wires.imu_frames = config.value.imu_frames;
  wires.nmea = config.value.nmea;
  replay::Drive drive{replay::open_drive_folder(feeder.folder(), wires), config.value.estimator.merge};
  Day day{config.value};
  Log log{*plan};
  while (day.take(drive)) log.look(day, drive);
  return log.is_good(day) ? 0 : 1;
}

}  // namespace
}  // namespace slamd::endurance

int main(int argc, char** argv) {
  std::string lap;
  double hours = 24.0;
  std::vector<std::string> overrides;
  CLI::App app{"Hours of one simulated lap, again and again, through slamd's estimator as fast as it goes."};
  app.add_option("LAP", lap, "drive folder of slam-sim that ends where it began, see the head of endurance.cpp")->required();
  app.add_option("--hours", hours, "of simulated time")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--set", overrides, "key=value over the default configuration, may be repeated");
  CLI11_PARSE(app, argc, argv);
  return slamd::endurance::run(lap, hours, overrides);
}
