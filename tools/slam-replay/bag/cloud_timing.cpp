#include "tools/slam-replay/bag/cloud_timing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::replay {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kShortestSweep_s = 0.005;  // of times in one cloud, for their unit to be known
constexpr double kLongestSweep_s = 0.5;
constexpr double kAbsolute_s = 1e6;         // larger times are since an epoch
constexpr double kSameClock_s = 1.0;

/// Of the time field, from how far apart its values are: units are a factor of 1,000 apart, sweeps are not.
std::optional<double> unit_of(double span) {
  for (const double unit_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    if (span * unit_s >= kShortestSweep_s && span * unit_s <= kLongestSweep_s) return unit_s;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> by_field(const CloudPoints& cloud, std::int64_t stamp_ns) {
  if (!cloud.has_time || cloud.points.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(cloud.points.begin(), cloud.points.end(),
                                                 [](const CloudPoint& a, const CloudPoint& b) { return a.time < b.time; });
  const std::optional<double> unit_s = unit_of(most->time - least->time);
  if (!unit_s) return std::nullopt;
  double zero = 0.0;
  if (std::abs(least->time) * *unit_s > kAbsolute_s) {
    const double stamp = static_cast<double>(stamp_ns) * 1e-9 / *unit_s;
    // Of another clock than the header's: the stamp is the first point's.
    zero = std::abs(least->time - stamp) * *unit_s < kSameClock_s ? stamp : least->time;
  }
  std::vector<double> times;
  times.reserve(cloud.points.size());
  for (const CloudPoint& point : cloud.points) times.push_back((point.time - zero) * *unit_s);
  return times;
}

/// One turn from the first point on, in the direction in which the points' azimuths go.
std::vector<double> by_azimuth(const CloudPoints& cloud, const CloudTimingConfig& config) {
  std::vector<double> azimuths;
  azimuths.reserve(cloud.points.size());
  double turned = 0.0;
  for (const CloudPoint& point : cloud.points) {
    const double azimuth = std::atan2(point.y, point.x);
    if (!azimuths.empty()) turned += std::remainder(azimuth - azimuths.back(), kTurn);
    azimuths.push_back(azimuth);
  }
  const double direction = turned > 0.0 ? 1.0 : -1.0;
  const double begin_s = config.stamp_is_begin ? 0.0 : -config.period_s;
  const double first = azimuths.empty() ? 0.0 : azimuths.front();
  for (double& azimuth : azimuths) {
    double share = std::fmod(direction * (azimuth - first) / kTurn + 2.0, 1.0);
    if (share > 0.999) share = 0.0;  // of the first firing itself
    azimuth = begin_s + share * config.period_s;
  }
  return azimuths;
}

float elevation(const CloudPoint& point) { return std::atan2(point.z, std::hypot(point.x, point.y)); }

}  // namespace

std::vector<double> point_times(const CloudPoints& cloud, std::int64_t stamp_ns, const CloudTimingConfig& config) {
  if (std::optional<std::vector<double>> times = by_field(cloud, stamp_ns)) return *std::move(times);
  return by_azimuth(cloud, config);
}

RingFinder::RingFinder(const std::vector<CloudPoint>& points) {
  constexpr float kGap_rad = 0.1F * std::numbers::pi_v<float> / 180.0F;  // between two lasers, at least
  constexpr std::size_t kMostLasers = 128;
  constexpr std::size_t kBands = 64;  // where no lasers can be told apart
  std::vector<float> elevations;
  for (const CloudPoint& point : points) elevations.push_back(elevation(point));
  std::sort(elevations.begin(), elevations.end());
  for (std::size_t begin = 0, i = 1; i <= elevations.size() && !elevations.empty(); ++i) {
    if (i < elevations.size() && elevations[i] - elevations[i - 1] < kGap_rad) continue;
    centres_rad_.push_back(elevations[(begin + i - 1) / 2]);
    begin = i;
  }
  if (elevations.empty() || (centres_rad_.size() >= 2 && centres_rad_.size() <= kMostLasers)) return;
  centres_rad_.clear();
  const float step = (elevations.back() - elevations.front()) / kBands;
  for (std::size_t i = 0; i < kBands; ++i) centres_rad_.push_back(elevations.front() + (static_cast<float>(i) + 0.5F) * step);
}

std::uint8_t RingFinder::ring(const CloudPoint& point) const {
  const float wanted = elevation(point);
  const auto above = std::lower_bound(centres_rad_.begin(), centres_rad_.end(), wanted);
  const bool below_is_nearer = above == centres_rad_.end() || (above != centres_rad_.begin() && wanted - *(above - 1) < *above - wanted);
  if (centres_rad_.empty()) return 0;
  return static_cast<std::uint8_t>(above - centres_rad_.begin() - (below_is_nearer ? 1 : 0));
}

}  // namespace slamd::replay
