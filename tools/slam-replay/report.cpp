#include "tools/slam-replay/report.hpp"

#include <nlohmann/json.hpp>

#include "daemon/health/process_memory.hpp"
#include "tools/slam-replay/report_parts.hpp"

namespace slamd::replay {

void StageTimes::begin_scan() {
  now_.fill(Duration::zero());
  begin_ = last_ = Clock::now();
}

void StageTimes::finished(Stage stage) {
  const Clock::time_point now = Clock::now();
  now_[static_cast<std::size_t>(stage)] += now - last_;
  last_ = now;
}

void StageTimes::end_scan() {
  scan_->record(Clock::now() - begin_);
  for (std::size_t i = 0; i < kStages; ++i) (*stages_)[i].record(now_[i]);
}

namespace {

Json drops(const Sensors& sensors, const OdometryStats& stats) {
  Json out{{"scans_late", stats.scans_late + stats.queue.overtaken}, {"scans_thinned", stats.scans_thinned},
           {"scans_let_go", stats.scans_let_go}};
  if (sensors.lidar) out["lidar_packets_lost"] = sensors.lidar->report().missing;
  if (sensors.imu) out["imu_samples_missing"] = sensors.imu->report().missing;
  return out;
}

Json rejections(const Sensors& sensors, const OdometryStats& stats) {
  Json out = stream_rejections(sensors);
  if (sensors.imu) {
    out["imu"]["out_of_order"] = stats.imu.out_of_order;
    out["imu"]["in_future"] = stats.imu.in_future;
    out["imu"]["frozen"] = stats.imu.frozen;
    out["imu"]["implausible"] = stats.imu.implausible;
  }
  out["scans_contradicting_imu"] = stats.imu_contradicted;
  out["scans_unfused"] = stats.fusion.unfused;
  out["scans_repeated"] = stats.queue.repeated;
  return out;
}

Json back_end(const GraphSolution& solution, const RelocaliserCounts& relocalisation) {
  return {{"solves", solution.changes},       {"closures", solution.closures},     {"positions", solution.positions},
          {"objective", solution.objective}, {"iterations", solution.iterations}, {"converged", solution.converged},
          {"relocalised", relocalisation.relocalised}, {"maps_begun_anew", relocalisation.begun_anew}};
}

/// yaw_sigma_rad and latency_sigma_s are the back end's own; latency_correction_s comes on top of gnss.latency_s.
Json gps(const EnuAlignment& enu, const GnssLatency& latency) {
  const Eigen::Vector3d& t = enu.translation;
  const Eigen::Vector4d sigma = enu.covariance.diagonal().cwiseSqrt();
  return {{"yaw_rad", enu.yaw_rad},
          {"yaw_sigma_rad", sigma[3]},
          {"translation_m", {t.x(), t.y(), t.z()}},
          {"translation_sigma_m", {sigma[0], sigma[1], sigma[2]}},
          {"latency_correction_s", latency.correction_s},
          {"latency_sigma_s", latency.sigma_s}};
}

Json origin(const EnuOrigin& enu) {
  return {{"lat_deg", enu.latitude_deg}, {"lon_deg", enu.longitude_deg}, {"ellipsoid_height_m", enu.ellipsoid_height_m}};
}

}  // namespace

std::string to_json(const Report& report, const StageTimes& times, const Sensors& sensors, const OdometryStats& stats) {
  constexpr double kMegabyte = 1024.0 * 1024.0;
  Json out{{"scans", report.scans},
           {"duration_s", to_seconds(report.drive)},
           {"realtime_factor", to_seconds(report.drive) / std::max(1e-9, to_seconds(report.wall))},
           {"peak_rss_mb", static_cast<double>(process_memory().peak_bytes) / kMegabyte},
           {"scan_ms", milliseconds(times.scan())}};
  for (std::size_t i = 0; i < kStages; ++i) {
    const Stage stage = static_cast<Stage>(i);
    out["stages_ms"][name(stage)] = milliseconds(times.stage(stage));
  }
  out["scans_fused"] = stats.fusion.fused;
  out["scans_standing"] = stats.standstills;
  out["map_restarts"] = stats.fusion.map_restarts;
  out["keyframes"] = report.keyframes;
  out["map_points"] = report.map_points;
  out["gps_fixes"] = report.fixes;
  out["drops"] = drops(sensors, stats);
  out["rejections"] = rejections(sensors, stats);
  out["status"] = status_line(report.status);
  const Matrix6d& p = report.last.covariance;
  out["final_sigma"] = {{"position_m", {std::sqrt(p(0, 0)), std::sqrt(p(1, 1)), std::sqrt(p(2, 2))}},
                        {"attitude_rad", {std::sqrt(p(3, 3)), std::sqrt(p(4, 4)), std::sqrt(p(5, 5))}}};
  if (report.solution != nullptr) out["back_end"] = back_end(*report.solution, report.relocalisation);
  if (report.solution != nullptr && report.solution->enu_valid) out["enu_origin"] = origin(report.solution->enu_origin);
  if (out.contains("enu_origin")) out["gps"] = gps(report.solution->enu, report.latency);
  return out.dump(1) + "\n";
}

}  // namespace slamd::replay
