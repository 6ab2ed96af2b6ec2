#include "estimator/grid/scan_2d.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "estimator/grid/scan_normals.hpp"

namespace slamd {

Scan2d::Scan2d(const VehicleGeometry& vehicle, const Scan2dConfig& config) : vehicle_{vehicle}, config_{config} {}

void Scan2d::take(const LaserScan& scan) {
  raw_.clear();
  has_heights_ = false;
  begin_ = end_ = scan.time;
  if (scan.beams.empty()) return;
  begin_ = scan.time + from_seconds(scan.beams.front().time_s);
  end_ = scan.time + from_seconds(scan.beams.back().time_s);
  const double max_range_m = std::min<double>(config_.max_range_m, scan.range_max_m > 0.0F ? scan.range_max_m : config_.max_range_m);
  for (const LaserBeam& beam : scan.beams) {
    if (!(beam.range_m >= config_.min_range_m && beam.range_m < max_range_m) || !std::isfinite(beam.angle_rad)) continue;
    const Eigen::Vector3d p_lidar{beam.range_m * std::cos(beam.angle_rad), beam.range_m * std::sin(beam.angle_rad), 0.0};
    raw_.push_back({(vehicle_.T_base_lidar * p_lidar).cast<float>(), beam.time_s - scan.beams.back().time_s});
  }
}

/// The ring whose rays run most nearly level, on the whole.
std::optional<int> Scan2d::level_ring(const Scan& scan) const {
  struct Slope {
    float sum = 0.0F, count = 0.0F;
  };
  std::array<Slope, 256> slopes{};
  for (const LidarPoint& point : scan.points) {
    const float range_m = Eigen::Vector3f{point.x, point.y, point.z}.norm();
    if (!(range_m > 0.0F)) continue;
    slopes[point.ring].sum += point.z / range_m;  // of the sensor itself: a mounting that leans tilts all rings alike
    slopes[point.ring].count += 1.0F;
  }
  std::optional<int> best;
  float least = 1.0F;
  for (std::size_t ring = 0; ring < slopes.size(); ++ring) {
    if (slopes[ring].count == 0.0F || std::abs(slopes[ring].sum / slopes[ring].count) >= least) continue;
    least = std::abs(slopes[ring].sum / slopes[ring].count);
    best = static_cast<int>(ring);
  }
  return best;
}

/// One ring has too few points to leave out those high up on walls; the ground it must not show: that moves with the vehicle.
float Scan2d::band_high() const {
  return config_.single_ring ? std::numeric_limits<float>::infinity() : static_cast<float>(config_.band_high_m);
}

/// A lean of 10 degrees moves a point's height by a sixth of its range: what is farther off the band can never be in it.
bool Scan2d::is_in_reach(const Eigen::Vector3f& p_base, float range_m) const {
  const float slack = 0.18F * range_m;
  return p_base.z() >= static_cast<float>(config_.band_low_m) - slack && p_base.z() <= band_high() + slack;
}

void Scan2d::take(const Scan& scan) {
  raw_.clear();
  has_heights_ = true;
  begin_ = scan.begin;
  end_ = scan.end;
  const std::optional<int> ring = config_.single_ring ? level_ring(scan) : std::nullopt;
  const auto span_s = static_cast<float>(to_seconds(scan.end - scan.begin));
  const Eigen::Matrix3f R = vehicle_.T_base_lidar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = vehicle_.T_base_lidar.translation.cast<float>();
  for (const LidarPoint& point : scan.points) {
    if (ring && point.ring != *ring) continue;
    const Eigen::Vector3f p_lidar{point.x, point.y, point.z};
    const float range_m = p_lidar.norm();
    if (!(range_m >= static_cast<float>(config_.min_range_m) && range_m < static_cast<float>(config_.max_range_m))) continue;
    const Eigen::Vector3f p = R * p_lidar + t;
    if (has_heights_ && !is_in_reach(p, range_m)) continue;
    raw_.push_back({p, static_cast<float>(point.time_offset_ns) * 1e-9F - span_s});
  }
}

Eigen::Matrix3d Scan2d::level_rotation(const Eigen::Vector3d& up_base) {
  const double pitch = std::asin(std::clamp(-up_base.x(), -1.0, 1.0));
  const double roll = std::atan2(up_base.y(), up_base.z());
  return (Eigen::AngleAxisd{pitch, Eigen::Vector3d::UnitY()} * Eigen::AngleAxisd{roll, Eigen::Vector3d::UnitX()})
      .toRotationMatrix();
}

void Scan2d::cut(const PlanarMotion& motion, const Eigen::Vector3d& up_base, PlanarScan& out) {
  out.time = end_;
  const Eigen::Matrix3f R_level_base = level_rotation(up_base).cast<float>();
  out.origin = (R_level_base * vehicle_.T_base_lidar.translation.cast<float>()).head<2>();
  // The motion changes little between neighbouring points: one transform a piece of the scan.
  constexpr float kPiece_s = 5e-4F;
  float piece_s = 1.0F;
  Eigen::Matrix2f R_end_then = Eigen::Matrix2f::Identity();
  Eigen::Vector2f t_end_then = Eigen::Vector2f::Zero();
  level_.clear();
  for (const RawPoint& raw : raw_) {
    if (std::abs(raw.before_end_s - piece_s) > kPiece_s) {
      piece_s = raw.before_end_s;
      const PlanarPose T_end_then = motion.relative_to_end(piece_s);
      R_end_then = T_end_then.rotation().cast<float>();
      t_end_then = T_end_then.translation.cast<float>();
    }
    const Eigen::Vector3f p = R_level_base * raw.p_base;
    if (has_heights_ && (p.z() < static_cast<float>(config_.band_low_m) || p.z() > band_high())) continue;
    level_.emplace_back(R_end_then * p.head<2>() + t_end_then);
  }
  double spacing_m = config_.spacing_m;
  thin(spacing_m, out.points);
  while (out.points.size() > config_.most_points) {
    level_ = out.points;
    thin(spacing_m *= 2.0, out.points);
  }
  float sum_m = 0.0F;
  for (const Eigen::Vector2f& p : out.points) sum_m += (p - out.origin).norm();
  out.mean_range_m = out.points.empty() ? 0.0F : sum_m / static_cast<float>(out.points.size());
  find_normals(out, spacing_m);
}

/// The mean of the points of each square of the spacing, in the order in which squares were first met.
void Scan2d::thin(double spacing_m, std::vector<Eigen::Vector2f>& out) {
  voxels_.clear();
  means_.clear();
  const auto per_m = static_cast<float>(1.0 / spacing_m);
  for (const Eigen::Vector2f& p : level_) {
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(p.x() * per_m)));
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(p.y() * per_m)));
    const std::uint64_t key = (static_cast<std::uint64_t>(x) << 32U) | y;
    const auto [found, is_new] = voxels_.try_emplace(key, static_cast<std::uint32_t>(means_.size()));
    if (is_new) means_.push_back({0.0F, 0.0F, 0.0F});
    Mean& mean = means_[found->second];
    mean.x += p.x();
    mean.y += p.y();
    mean.count += 1.0F;
  }
  out.clear();
  for (const Mean& mean : means_) out.emplace_back(mean.x / mean.count, mean.y / mean.count);
}

}  // namespace slamd
