#pragma once
// What a replay tells of itself: timings, counts by cause and the time line of the status, as report.json.

#include <array>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "daemon/health/histogram.hpp"
#include "estimator/graph/gnss_latency.hpp"
#include "estimator/graph/graph_solution.hpp"
#include "estimator/graph/relocaliser.hpp"
#include "estimator/odometry/lidar_inertial_odometry.hpp"
#include "estimator/types/stage.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// Times each stage of each scan by the steady clock.
class StageTimes : public StageListener {
 public:
  StageTimes() : stages_{std::make_unique<std::array<Histogram, kStages>>()}, scan_{std::make_unique<Histogram>()} {}

  void begin_scan();
  void finished(Stage stage) override;
  /// The scan was fused or given up: its stages count. Without this call they are forgotten.
  void end_scan();

  const Histogram& scan() const { return *scan_; }
  const Histogram& stage(Stage stage) const { return (*stages_)[static_cast<std::size_t>(stage)]; }

 private:
  using Clock = std::chrono::steady_clock;
  std::unique_ptr<std::array<Histogram, kStages>> stages_;
  std::unique_ptr<Histogram> scan_;
  std::array<Duration, kStages> now_{};
  Clock::time_point begin_, last_;
};

/// A change of status: it holds from `time` until the next entry.
struct StatusChange {
  HostTime time;
  TrackingStatus status;
  std::uint32_t reasons;
};

struct Report {
  std::uint64_t scans = 0;         // poses in odom.tum
  std::uint64_t keyframes = 0;
  std::uint64_t map_points = 0;
  std::uint64_t fixes = 0;
  Duration drive{};                // from the first event's arrival to the last one's
  Duration wall{};                 // the replay took, without writing the map
  std::vector<StatusChange> status;
  NavState last;
  std::shared_ptr<const GraphSolution> solution;  // the last one; null without the back end
  GnssLatency latency;
  RelocaliserCounts relocalisation;
};

/// report.json as text; see README.md for the keys.
std::string to_json(const Report& report, const StageTimes& times, const Sensors& sensors, const OdometryStats& stats);

}  // namespace slamd::replay
