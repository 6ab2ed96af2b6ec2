#include "daemon/store/ray_image.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLowestLaser_rad = -15.0F * kPi / 180.0F;
constexpr float kRowPitch_rad = 2.0F * kPi / 180.0F;
constexpr float kSteepestSine = 0.30F;
constexpr float kNearest_m = 1.5F;
constexpr float kFarthest_m = 45.0F;   // beyond it an error of 0.3 degrees is as large as what is asked about
constexpr float kNearRay = 0.006F;     // distance from the ray to the point by its range: 0.35 degrees
constexpr float kNearRay_m = 0.03F;    // and what poses and ranges add
constexpr float kSeenMargin_m = 0.30F;
constexpr float kPassedMargin_m = 0.60F;
constexpr float kOnSurface_m = 0.30F;
constexpr float kLeastIncidence = 0.10F;  // sine: no ray that grazes more than this is a witness
constexpr float kOneSurface = 0.12F;      // neighbouring ranges of one surface differ by less than this share
constexpr int kSideColumns = 4;

int wrapped(int column, int columns) { return column < 0 ? column + columns : column >= columns ? column - columns : column; }

/// atan2 to some 2e-4 rad, which is a thirtieth of a column: every point of a scan asks for it.
float quick_atan2(float y, float x) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float a = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-9F);
  const float s = a * a;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * a + a;
  if (ay > ax) angle = 0.5F * kPi - angle;
  if (x < 0.0F) angle = kPi - angle;
  return y < 0.0F ? -angle : angle;
}

int column_of(const Eigen::Vector3f& direction, int columns) {
  const float turn = quick_atan2(direction.y(), direction.x()) / (2.0F * kPi) + 0.5F;
  return std::clamp(static_cast<int>(turn * static_cast<float>(columns)), 0, columns - 1);
}

}  // namespace

RayImage::RayImage() : rays_(static_cast<std::size_t>(kRows) * kColumns) { sensor_.fill(Eigen::Vector3f::Zero()); }

const RayImage::Ray& RayImage::ray(int row, int column) const {
  return rays_[static_cast<std::size_t>(row * kColumns + wrapped(column, kColumns))];
}

Eigen::Vector3f RayImage::end_of(Cell cell) const {
  const Ray& found = ray(cell.row, cell.column);
  return sensor_[static_cast<std::size_t>(wrapped(cell.column, kColumns))] + found.range_m * found.direction;
}

std::optional<RayImage::Cell> RayImage::cell_of(const Eigen::Vector3f& from_sensor) const {
  const float sine = from_sensor.z() / std::max(from_sensor.norm(), 1e-3F);
  if (std::abs(sine) > kSteepestSine) return std::nullopt;
  const float elevation = sine + sine * sine * sine / 6.0F;  // asin to 2e-4 rad in this range
  const int row = static_cast<int>(std::lround((elevation - kLowestLaser_rad) / kRowPitch_rad));
  if (row < 0 || row >= kRows) return std::nullopt;
  return Cell{row, column_of(from_sensor, kColumns)};
}

void RayImage::place_sensor(const Keyframe& keyframe, const Pose& T_base_lidar) {
  const Pose T_lidar_base = T_base_lidar.inverse();
  const Eigen::Vector3d velocity_base = keyframe.state.T_odom_base.rotation.conjugate() * keyframe.state.velocity_mps;
  const Eigen::Vector3d velocity_lidar =
      T_lidar_base.rotation * (velocity_base + keyframe.state.angular_velocity_rads.cross(T_base_lidar.translation));
  const Eigen::Vector3f whole = (velocity_lidar * to_seconds(keyframe.scan_span)).cast<float>();
  const CloudPoint& first = keyframe.points.front();
  const Eigen::Vector3d first_lidar = T_lidar_base * Eigen::Vector3d{first.x, first.y, first.z};
  const int first_column = column_of(first_lidar.cast<float>(), kColumns);
  for (int column = 0; column < kColumns; ++column) {
    const float left = 1.0F - static_cast<float>(wrapped(first_column - column, kColumns)) / kColumns;
    sensor_[static_cast<std::size_t>(column)] = -left * whole;
  }
}

void RayImage::draw(const Keyframe& keyframe, const Pose& T_base_lidar) {
  std::fill(rays_.begin(), rays_.end(), Ray{});
  if (keyframe.points.empty()) return;
  place_sensor(keyframe, T_base_lidar);
  const Pose T_lidar_base = T_base_lidar.inverse();
  const Eigen::Matrix3f R = T_lidar_base.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_lidar_base.translation.cast<float>();
  for (const CloudPoint& point : keyframe.points) {
    const Eigen::Vector3f p = R * Eigen::Vector3f{point.x, point.y, point.z} + t;
    if (!p.allFinite()) continue;
    const Eigen::Vector3f from_sensor = p - sensor_[static_cast<std::size_t>(column_of(p, kColumns))];
    const std::optional<Cell> cell = cell_of(from_sensor);
    const float range_m = from_sensor.norm();
    if (!cell || range_m < kNearest_m) continue;
    Ray& nearest = rays_[static_cast<std::size_t>(cell->row * kColumns + cell->column)];
    if (nearest.range_m == 0.0F || range_m < nearest.range_m) nearest = {from_sensor / range_m, range_m};
  }
}

RayImage::Witness RayImage::ask(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
  const Eigen::Vector3f from_sensor = p - sensor_[static_cast<std::size_t>(column_of(p, kColumns))];
  const float range2 = from_sensor.squaredNorm();
  if (range2 < kNearest_m * kNearest_m || range2 > kFarthest_m * kFarthest_m) return Witness::kNothing;
  const std::optional<Cell> cell = cell_of(from_sensor);
  if (!cell) return Witness::kNothing;
  const Ray& near_by = ray(cell->row, cell->column);
  if (near_by.range_m == 0.0F) return Witness::kNothing;
  const float along = near_by.direction.dot(from_sensor);
  const float off = std::sqrt(std::max(0.0F, range2 - along * along));
  const float tolerance = kNearRay_m + kNearRay * along;
  if (off > tolerance) return Witness::kNothing;
  const float incidence = normal.isZero() ? 1.0F : std::abs(normal.dot(near_by.direction));
  const float slack = tolerance / std::max(incidence, kLeastIncidence);
  const float beyond = near_by.range_m - along;
  if (std::abs(beyond) < kSeenMargin_m + slack) return Witness::kSeen;
  if (beyond < kPassedMargin_m + slack || incidence < kLeastIncidence) return Witness::kNothing;
  if (is_edge(*cell, along + kPassedMargin_m) || lies_on_surface_of(*cell, p)) return Witness::kNothing;
  return Witness::kPassed;
}

/// Did a neighbouring ray end before range_m? Then this one passes something by.
bool RayImage::is_edge(Cell cell, float range_m) const {
  const auto nearer = [&](int column) {
    const Ray& side = ray(cell.row, column);
    return side.range_m == 0.0F || side.range_m < range_m;
  };
  return nearer(cell.column - 1) || nearer(cell.column + 1);
}

/// Is p on the plane that the ray and its neighbours hit? True as well where they hit none that can be told.
bool RayImage::lies_on_surface_of(Cell cell, const Eigen::Vector3f& p) const {
  const Eigen::Vector3f end = end_of(cell);
  int planes = 0;
  for (const int row : {cell.row - 1, cell.row + 1}) {
    const Eigen::Vector3f normal = normal_of(cell, row);
    if (normal.isZero()) continue;
    ++planes;
    if (std::abs(normal.dot(p - end)) < kOnSurface_m) return true;
  }
  return planes == 0;
}

/// Of the plane through the ends of a cell's ray, of one beside it and of one in the other row; zero where there is none.
Eigen::Vector3f RayImage::normal_of(Cell cell, int other_row) const {
  if (other_row < 0 || other_row >= kRows) return Eigen::Vector3f::Zero();
  const Cell other{other_row, cell.column};
  if (ray(other.row, other.column).range_m == 0.0F) return Eigen::Vector3f::Zero();
  const float range_m = ray(cell.row, cell.column).range_m;
  const Eigen::Vector3f end = end_of(cell);
  for (const int side : {-kSideColumns, kSideColumns}) {
    const float side_range_m = ray(cell.row, cell.column + side).range_m;
    if (std::abs(side_range_m - range_m) > kOneSurface * range_m) continue;
    const Eigen::Vector3f across = end_of({cell.row, cell.column + side}) - end;
    const Eigen::Vector3f normal = across.cross(end_of(other) - end);
    const float length = normal.norm();
    if (length > 1e-4F) return normal / length;
  }
  return Eigen::Vector3f::Zero();
}

Eigen::Vector3f RayImage::normal_at(const Eigen::Vector3f& p) const {
  const std::optional<Cell> cell = cell_of(p - sensor_[static_cast<std::size_t>(column_of(p, kColumns))]);
  if (!cell || ray(cell->row, cell->column).range_m == 0.0F) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f below = normal_of(*cell, cell->row - 1);
  const Eigen::Vector3f above = normal_of(*cell, cell->row + 1);
  if (below.isZero()) return above;
  if (above.isZero()) return below;
  constexpr float kAgree = 0.8F;
  return std::abs(below.dot(above)) > kAgree ? below : Eigen::Vector3f::Zero();
}

}  // namespace slamd
