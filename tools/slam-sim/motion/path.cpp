#include "tools/slam-sim/motion/path.hpp"

#include <cmath>

namespace slamd::sim {
namespace {

constexpr int kSubSteps = 8;  // table entries per control point

}  // namespace

Path::Path(const Route& route, int laps) : knot_step_{1.0 / kSubSteps} {
  std::vector<Eigen::Vector2d> samples;
  const int rounds = route.closed ? laps : 1;
  for (int lap = 0; lap < rounds; ++lap) samples.insert(samples.end(), route.points.begin(), route.points.end());
  if (route.closed) samples.push_back(route.points.front());
  curve_ = UniformSpline<2>(0.0, 1.0, samples);
  double length = 0.0;
  const int entries = static_cast<int>(samples.size() - 1) * kSubSteps;
  for (int i = 0; i <= entries; ++i) {
    arc_.push_back(length);
    const double u = i * knot_step_;
    // Simpson's rule for the speed over the entry.
    const double speeds = curve_.at(u).first.norm() + 4.0 * curve_.at(u + 0.5 * knot_step_).first.norm() +
                          curve_.at(u + knot_step_).first.norm();
    length += speeds * knot_step_ / 6.0;
  }
}

double Path::parameter(double s) const {
  const auto above = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s);
  const double low = *(above - 1);
  const double within = std::clamp((s - low) / (*above - low), 0.0, 1.0);
  return (static_cast<double>(above - 1 - arc_.begin()) + within) * knot_step_;
}

PathPoint Path::at(double s) const {
  const auto curve = curve_.at(parameter(s));
  const Eigen::Vector2d d = curve.first;
  const double cross = d.x() * curve.second.y() - d.y() * curve.second.x();
  return {curve.value, std::atan2(d.y(), d.x()), cross / std::pow(d.squaredNorm(), 1.5)};
}

}  // namespace slamd::sim
