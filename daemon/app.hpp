#pragma once
// The whole daemon, wired: every part is made here, started in order and stopped in reverse. It computes nothing.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/threads/mapping_thread.hpp"
#include "daemon/threads/supervisor.hpp"
#include "daemon/threads/worker.hpp"

namespace slamd {

/// One thread calls all methods.
class App {
 public:
  /// Takes all memory that the configuration asks for and binds the LiDAR's ports; fails when it cannot. With a folder
  /// all that the sensors send is recorded there.
  static Result<std::unique_ptr<App>> open(const Config& config, const std::string& version,
                                           const std::string& record_folder = "");
  ~App() { stop(); }

  /// Starts every thread, consumers before producers, then the server. On failure nothing is left running.
  Result<void> start();

  /// One look at all threads, for the log. False when a thread has ended by itself: the daemon should stop.
  bool supervise();

  /// Stops in reverse order of the start, within a second; idempotent.
  void stop();

  /// Any thread. Scans and keyframes since the start.
  std::uint64_t scans() const { return estimator_.scans(); }
  std::uint64_t keyframes() const { return estimator_.keyframes(); }

 private:
  App(const Config& config, const std::string& version, PosePublisher publisher, std::unique_ptr<Streams> streams,
      LidarThread lidar);

  template <class Part>
  void start_thread(const ThreadSchedule& schedule, Part& part);
  void tell_refusals(const Result<void>& memory_locked);
  void record(std::unique_ptr<Recorder> recorder);
  void register_probes();
  void add_source(const std::string& name, const HealthBoard::SourceProbe& probe);
  void add_ring(const std::string& name, const HealthBoard::RingProbe& probe);

  const Config config_;
  Log log_;
  PosePublisher publisher_;
  MapStore map_;
  TrajectoryStore trajectory_;
  std::unique_ptr<Streams> streams_;
  LidarThread lidar_;
  ImuThread imu_;
  GnssThread gnss_;
  std::unique_ptr<Recorder> recorder_;  // null: no recording
  EstimatorThread estimator_;
  MappingThread mapping_;
  HealthBoard health_;
  Supervisor supervisor_;
  Server server_;
  std::vector<std::unique_ptr<Worker>> workers_;  // in order of their start
};

}  // namespace slamd
