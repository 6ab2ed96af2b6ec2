#include "tools/slam-replay/planar_replay.hpp"

#include <algorithm>
#include <fstream>

#include "daemon/health/process_memory.hpp"
#include "daemon/store/cloud_file.hpp"
#include "daemon/store/grid_file.hpp"
#include "tools/slam-replay/report_parts.hpp"

namespace slamd::replay {
namespace {

Pose in_space(const PlanarPose& T) {
  return {Eigen::Quaterniond{Eigen::AngleAxisd{T.yaw_rad, Eigen::Vector3d::UnitZ()}}, {T.translation.x(), T.translation.y(), 0.0}};
}

PlanarPose in_plane(const Pose& T) {
  const Eigen::Matrix3d R = T.rotation.toRotationMatrix();
  return {T.translation.head<2>(), std::atan2(R(1, 0), R(0, 0))};
}

/// As the recording writes it.
HostTime recorded(const Sensors& sensors, HostTime time) {
  const auto found = sensors.recorded_stamps.find(time);
  return found == sensors.recorded_stamps.end() ? time : found->second;
}

bool save(const std::string& text, const std::string& path) {
  const Result<UniqueFd> file = text_memfd(text);
  return file && save_atomically(file->get(), path);
}

}  // namespace

PlanarReplay::PlanarReplay(const VehicleGeometry& vehicle, const Slam2dConfig& config, const ScanAssemblerConfig& assembler)
    : slam_{vehicle, config}, assembler_{assembler} {}

void PlanarReplay::run(Drive& drive, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  while (take(drive.next())) progress.show(drive.progress());
  if (assembler_.finish()) {
    assembler_.take(scan_);
    scan(scan_);
  }
  slam_.finish();
  report_.drive = last_ - first_;
  report_.wall = std::chrono::steady_clock::now() - begin;
}

bool PlanarReplay::take(const Event& event) {
  const auto note = [this](HostTime arrival) {
    if (first_ == HostTime{}) first_ = arrival;
    last_ = std::max(last_, arrival);
  };
  if (const auto* sample = std::get_if<const ImuSample*>(&event)) {
    note((*sample)->arrival);
    slam_.add(**sample);
  } else if (const auto* wheels = std::get_if<const WheelOdometry*>(&event)) {
    note((*wheels)->arrival);
    ++report_.wheels;
    slam_.add(**wheels);
    wheels_.push_back({(*wheels)->time, {{(*wheels)->x_m, (*wheels)->y_m}, (*wheels)->yaw_rad}});
  } else if (const auto* laser = std::get_if<const LaserScan*>(&event)) {
    note((*laser)->arrival);
    scan(**laser);
  } else if (const auto* packet = std::get_if<const LidarPacket*>(&event)) {
    note((*packet)->arrival);
    if (assembler_.add(**packet)) {
      assembler_.take(scan_);
      scan(scan_);
    }
  }
  return !std::holds_alternative<std::monostate>(event);
}

template <class AnyScan>
void PlanarReplay::scan(const AnyScan& scan) {
  times_.begin_scan();
  const PlanarResult* result = slam_.add(scan);
  if (result == nullptr) return;
  times_.end_scan();
  keep(result->state);
  while (slam_.work()) {
  }
}

void PlanarReplay::keep(const NavState& state) {
  ++report_.scans;
  path_.push_back(state);
  const bool changed = report_.status.empty() || report_.status.back().status != state.status ||
                       report_.status.back().reasons != state.reasons;
  if (changed) report_.status.push_back({state.time, state.status, state.reasons});
}

PlanarPose PlanarReplay::in_map(const NavState& state) const { return slam_.to_map(state.time, in_plane(state.T_odom_base)); }

bool PlanarReplay::write(const Sensors& sensors, const std::string& folder) const {
  const OccupancyGrid grid = slam_.grid();
  return write_trajectories(sensors, folder) && write_wheel_rate(sensors, folder) &&
         save(grid_picture(grid), folder + "/map.pgm") && save(grid_yaml(grid, "map.pgm"), folder + "/map.yaml") &&
         save(to_json(sensors), folder + "/report.json");
}

bool PlanarReplay::write_trajectories(const Sensors& sensors, const std::string& folder) const {
  Output output{folder};  // odom.tum, covariance.csv
  std::ofstream map{folder + "/map.tum"};
  for (const NavState& state : path_) {
    NavState stamped = state;
    stamped.time = recorded(sensors, state.time);
    output.scan(stamped);
    const PlanarPose T_map_odom = in_map(state) * in_plane(state.T_odom_base).inverse();
    write_tum(map, stamped.time, in_space(T_map_odom) * state.T_odom_base);
  }
  map.flush();
  return output.finish() && map.good();
}

/// Between two scans the wheels' word from the earlier one, bent so that it ends at the later one.
bool PlanarReplay::write_wheel_rate(const Sensors& sensors, const std::string& folder) const {
  if (wheels_.empty() || path_.empty()) return true;
  std::ofstream out{folder + "/wheel_rate.tum"};
  const auto wheel_at = [this](HostTime time) {
    const auto found = std::ranges::lower_bound(wheels_, time, {}, &WheelPose::time);
    return found == wheels_.end() ? wheels_.back().T_wheel_base : found->T_wheel_base;
  };
  for (const WheelPose& wheel : wheels_) {
    const auto after = std::ranges::lower_bound(path_, wheel.time, {}, &NavState::time);
    const NavState& a = after == path_.begin() ? path_.front() : *std::prev(after);
    const NavState& b = after == path_.end() ? path_.back() : *after;
    const PlanarPose by_a = in_map(a) * (wheel_at(a.time).inverse() * wheel.T_wheel_base);
    const PlanarPose by_b = in_map(b) * (wheel_at(b.time).inverse() * wheel.T_wheel_base);
    const double span_s = to_seconds(b.time - a.time);
    const double share = span_s > 0.0 ? std::clamp(to_seconds(wheel.time - a.time) / span_s, 0.0, 1.0) : 0.0;
    write_tum(out, recorded(sensors, wheel.time), in_space(GroupSe2::plus(by_a, share * GroupSe2::minus(by_b, by_a))));
  }
  out.flush();
  return out.good();
}

std::string PlanarReplay::to_json(const Sensors& sensors) const {
  constexpr double kMegabyte = 1024.0 * 1024.0;
  const PlanarOdometryStats& stats = slam_.odometry().stats();
  Json out{{"mode", "planar"},
           {"scans", report_.scans},
           {"duration_s", to_seconds(report_.drive)},
           {"realtime_factor", to_seconds(report_.drive) / std::max(1e-9, to_seconds(report_.wall))},
           {"peak_rss_mb", static_cast<double>(process_memory().peak_bytes) / kMegabyte},
           {"scan_ms", milliseconds(times_.scan())},
           {"keyframes", slam_.mapper().keyframes().size()},
           {"loop_looks", slam_.mapper().stats().looks},
           {"closures", slam_.mapper().stats().closures},
           {"solves", slam_.mapper().stats().solves},
           {"wheel_odometry", report_.wheels},
           {"scans_unmatched", stats.unmatched}};
  out["rejections"] = stream_rejections(sensors);
  out["rejections"]["scans_empty"] = stats.empty;
  out["rejections"]["scans_out_of_order"] = stats.out_of_order;
  out["stamps_repaired"] = sensors.recorded_stamps.size();
  out["status"] = status_line(report_.status);
  return out.dump(1) + "\n";
}

}  // namespace slamd::replay
