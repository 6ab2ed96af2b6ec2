#pragma once
// A recorded drive through planar SLAM, and its files. The replay in space is replay.hpp.

#include <string>
#include <vector>

#include "estimator/grid/slam_2d.hpp"
#include "estimator/lidar/scan_assembler.hpp"
#include "tools/progress/progress.hpp"
#include "tools/slam-replay/drive/drive.hpp"
#include "tools/slam-replay/output.hpp"
#include "tools/slam-replay/report.hpp"

namespace slamd::replay {

struct PlanarReport {
  std::uint64_t scans = 0, wheels = 0;
  Duration drive{}, wall{};
  std::vector<StatusChange> status;
};

class PlanarReplay {
 public:
  PlanarReplay(const VehicleGeometry& vehicle, const Slam2dConfig& config, const ScanAssemblerConfig& assembler);

  /// All of the drive; what the back end has to do is done as soon as it can.
  void run(Drive& drive, Progress& progress);
  /// odom.tum, map.tum, wheel_rate.tum, covariance.csv, map.pgm, map.yaml, report.json. False: cannot write there.
  bool write(const Sensors& sensors, const std::string& folder) const;

  const PlanarReport& report() const { return report_; }

 private:
  struct WheelPose {
    HostTime time;
    PlanarPose T_wheel_base;
  };
  bool take(const Event& event);
  template <class AnyScan>
  void scan(const AnyScan& scan);
  void keep(const NavState& state);
  bool write_trajectories(const Sensors& sensors, const std::string& folder) const;
  bool write_wheel_rate(const Sensors& sensors, const std::string& folder) const;
  std::string to_json(const Sensors& sensors) const;
  PlanarPose in_map(const NavState& state) const;

  Slam2d slam_;
  ScanAssembler assembler_;
  Scan scan_;
  std::vector<NavState> path_;      // one a scan
  std::vector<WheelPose> wheels_;   // one a record
  StageTimes times_;
  PlanarReport report_;
  HostTime first_{}, last_{};
};

}  // namespace slamd::replay
