#include "tools/slam-replay/back_end_output.hpp"

#include <array>
#include <cstdio>

#include "estimator/graph/correction.hpp"

namespace slamd::replay {
namespace {

/// T_a_map is identity for map.tum, T_enu_map for enu.tum.
bool write_path(const Replay& replay, const Pose& T_a_map, const std::string& path) {
  std::ofstream out{path};
  const GraphSolution& solution = *replay.mapper().solution();
  for (const StampedPose& pose : replay.path()) {
    write_tum(out, pose.time, T_a_map * corrected_pose(solution, pose.time, pose.T_odom_base));
  }
  out.flush();
  return out.good();
}

void write_row(std::ostream& out, const LoopCandidateReport& report) {
  std::array<char, 480> text;
  const Eigen::Vector3d& t = report.T_from_to.translation;
  const Eigen::Quaterniond& q = report.T_from_to.rotation;
  std::snprintf(text.data(), text.size(),
                "%llu,%llu,%d,%d,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.7f,%.7f,%.7f,%.7f\n",
                static_cast<unsigned long long>(report.from), static_cast<unsigned long long>(report.to),
                static_cast<int>(report.ended_at), report.by_appearance ? 1 : 0, report.distance_m,
                report.descriptor_distance, report.fitness, report.overlap, report.free_space_share,
                report.odometry_chi2, report.consistency_chi2, report.graph_weight, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                q.w());
  out << text.data();
}

bool write_closures(const Replay& replay, const std::string& path) {
  std::ofstream out{path};
  out << "from,to,ended_at,by_appearance,distance_m,descriptor_distance,fitness,overlap,free_space_share,odometry_chi2,"
         "consistency_chi2,graph_weight,x_m,y_m,z_m,qx,qy,qz,qw\n";
  for (const LoopCandidateReport& report : replay.mapper().loop_reports()) write_row(out, report);
  out.flush();
  return out.good();
}

bool write_fixes(const Replay& replay, const std::string& path) {
  std::ofstream out{path};
  out << "t_ns,verdict,chi2,innovation_m,sigma_m\n";
  for (const FixReport& report : replay.mapper().fix_reports()) {
    std::array<char, 160> text;
    std::snprintf(text.data(), text.size(), "%lld,%d,%.4f,%.4f,%.3f\n", static_cast<long long>(to_ns(report.time)),
                  static_cast<int>(report.verdict), report.chi2, report.innovation_m, report.sigma_m);
    out << text.data();
  }
  out.flush();
  return out.good();
}

}  // namespace

bool write_back_end(const Replay& replay, const std::string& folder) {
  const GraphSolution& solution = *replay.mapper().solution();
  const bool written = write_path(replay, {}, folder + "/map.tum") && write_closures(replay, folder + "/closures.csv") &&
                       write_fixes(replay, folder + "/gps.csv");
  if (!solution.enu_valid) return written;
  return written && write_path(replay, solution.enu.T_enu_map(), folder + "/enu.tum");
}

}  // namespace slamd::replay
