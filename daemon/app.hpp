#pragma once
// The whole daemon, wired: every part is made here, started in order and stopped in reverse. It computes nothing.

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/service/watchdog.hpp"
#include "daemon/threads/mapping_thread.hpp"
#include "daemon/threads/planar_mapping_thread.hpp"
#include "daemon/threads/supervisor.hpp"
#include "daemon/threads/worker.hpp"

namespace slamd {

/// One thread calls all methods.
class App {
 public:
  /// Takes all memory that the configuration asks for and binds the LiDAR's ports; fails when it cannot. With a folder,
  /// or a file that ends in .mcap, all that the sensors send is recorded there. kept_page: the pose page of the daemon before this one, if any.
  static Result<std::unique_ptr<App>> open(const Config& config, const std::string& version,
                                           const std::string& record_folder = "", UniqueFd kept_page = {});
  ~App() { stop(); }

  /// Starts every thread, consumers before producers, then the server, on `listening` when that is a socket. On failure
  /// nothing is left running.
  Result<void> start(UniqueFd listening = {});

  /// One look at all threads, for the log. False when a thread has ended by itself: the daemon should stop.
  bool supervise();

  /// Takes over the changes of `wanted`, all of them or none. Returns the keys that only a restart can change: empty when
  /// it was done.
  std::vector<std::string> reload(const Config& wanted);

  /// Names every part whose standstill is a fault. They must not be asked after the app has gone.
  void watch(Watchdog& watchdog);

  /// How all stands now, in one line for people.
  std::string summary() const { return supervisor_.summary(); }

  void log(LogLevel level, const std::string& line) { log_.write(level, line); }

  /// The pose page, for open() of the next daemon.
  int page_to_keep() const { return publisher_.keep_fd(); }

  /// Stops in reverse order of the start, within a second; idempotent.
  void stop();

  /// Any thread. Scans and keyframes since the start.
  std::uint64_t scans() const { return estimator_.scans(); }
  std::uint64_t keyframes() const { return estimator_.keyframes(); }
  const Histogram& scan_latency() const { return estimator_.scan_latency(); }  // end of a scan to its posterior

 private:
  /// configured  as the operator said, for reloads; config  with what a checkpoint knows better
  App(const Config& configured, const Config& config, const std::string& version, PosePublisher publisher,
      std::unique_ptr<Streams> streams, std::unique_ptr<LidarThread> lidar);

  template <class Part>
  void start_thread(const ThreadSchedule& schedule, Part& part);
  void tell_refusals(std::set<std::string> reasons);
  Result<void> record(std::unique_ptr<Recorder> recorder, const Config& running, const std::string& target);
  RecordingControl recording_control();
  void watch_recording();
  bool tell_checkpoint(const char* refused, std::size_t keyframes);
  void resume(Result<StoredMap> map);
  void resume(const Result<StoredPlanarMap>& map);
  CheckpointReport checkpoint_report() const;
  RelocaliserCounts relocalisation() const;
  void tell_map_events();
  void dump_when_lost(HostTime now);
  void register_probes();
  void register_sensors();
  void allow_faults();
  void watch_budgets();
  bool is_planar() const { return config_.mode == "planar"; }
  void add_source(const std::string& name, const HealthBoard::SourceProbe& probe);
  void add_ring(const std::string& name, const HealthBoard::RingProbe& probe);

  Config config_;
  Log log_;
  PosePublisher publisher_;
  MapStore map_;
  GridStore grid_;
  TrajectoryStore trajectory_;
  UniqueFd cpu_latency_;  // the limit holds as long as it is open
  std::unique_ptr<Streams> streams_;
  std::unique_ptr<LidarThread> lidar_;
  ImuThread imu_;
  GnssThread gnss_;
  WheelThread wheel_;
  std::unique_ptr<Recorder> recorder_;
  EstimatorThread estimator_;
  CheckpointThread checkpoints_;
  MappingThread mapping_;                               // of full mode,
  std::unique_ptr<PlanarMappingThread> planar_mapping_;  // of planar mode; else null
  HealthBoard health_;
  Supervisor supervisor_;
  RelocaliserCounts told_map_events_;
  bool was_lost_ = false;
  HostTime dumped_at_;
  Server server_;
  std::vector<std::unique_ptr<Worker>> workers_;  // in order of their start
};

}  // namespace slamd
