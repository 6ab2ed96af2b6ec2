#include "tools/slam-sim/motion/speed_profile.hpp"

#include <cmath>

namespace slamd::sim {
namespace {

constexpr double kGrid = 0.1;       // metres
constexpr double kSmoothing = 0.4;  // half width, seconds

/// Speeds on a grid along the leg: limits first, then what can be reached forwards and braked backwards.
std::vector<double> leg_speeds(const Path& path, const Leg& leg, const SpeedLimits& limits, double first_speed) {
  const double length = std::abs(leg.to_m - leg.from_m);
  const double way = leg.to_m >= leg.from_m ? 1.0 : -1.0;
  const int cells = std::max(1, static_cast<int>(std::ceil(length / kGrid)));
  const double step = length / cells;
  std::vector<double> speeds(static_cast<std::size_t>(cells) + 1);
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const double curvature = std::abs(path.at(leg.from_m + way * step * static_cast<double>(i)).curvature_per_m);
    const double limit = way > 0.0 ? limits.speed_mps : 0.6 * limits.speed_mps;
    speeds[i] = std::min(limit, std::sqrt(limits.lateral_mps2 / std::max(curvature, 1e-6)));
  }
  speeds.front() = std::min(speeds.front(), first_speed);
  speeds.back() = 0.0;
  for (std::size_t i = 1; i < speeds.size(); ++i) {
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i - 1] * speeds[i - 1] + 2 * limits.acceleration_mps2 * step));
  }
  for (std::size_t i = speeds.size() - 1; i-- > 0;) {
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i + 1] * speeds[i + 1] + 2 * limits.braking_mps2 * step));
  }
  return speeds;
}

/// Appends s every step_s until the leg's end.
void drive_leg(const std::vector<double>& speeds, const Leg& leg, double step_s, std::vector<double>& out) {
  const double cell = (leg.to_m - leg.from_m) / static_cast<double>(speeds.size() - 1);
  double at_cell = 0.0;  // time when the cell begins
  double next = step_s;
  for (std::size_t i = 0; i + 1 < speeds.size(); ++i) {
    const double period = 2.0 * std::abs(cell) / (speeds[i] + speeds[i + 1]);
    const double acceleration = (speeds[i + 1] - speeds[i]) / period;
    for (; next <= at_cell + period; next += step_s) {
      const double t = next - at_cell;
      const double way = speeds[i] * t + 0.5 * acceleration * t * t;
      out.push_back(leg.from_m + cell * static_cast<double>(i) + std::copysign(way, cell));
    }
    at_cell += period;
  }
}

std::vector<double> smoothed(const std::vector<double>& s, double step_s) {
  const int half = static_cast<int>(kSmoothing / step_s);
  const int last = static_cast<int>(s.size()) - 1;
  const auto at = [&](int i) {  // held at the end, straight on at the start, so that a moving start keeps its speed
    return i < 0 ? 2 * s.front() - s[static_cast<std::size_t>(std::min(-i, last))]
                 : s[static_cast<std::size_t>(std::min(i, last))];
  };
  std::vector<double> out(s.size());
  for (int i = 0; i <= last; ++i) {
    double sum = 0.0;
    for (int j = -half; j <= half; ++j) sum += at(i + j);
    out[static_cast<std::size_t>(i)] = sum / (2 * half + 1);
  }
  return out;
}

}  // namespace

std::vector<double> distance_over_time(const Path& path, const SpeedPlan& plan, double step_s) {
  const auto rest = [&](std::vector<double>& out, double where, double period_s) {
    out.insert(out.end(), static_cast<std::size_t>(period_s / step_s), where);
  };
  std::vector<double> s{plan.legs.empty() ? 0.0 : plan.legs.front().from_m};
  if (plan.rest_at_start_s > 0.0) rest(s, s.front(), plan.rest_at_start_s + kSmoothing);
  double speed = plan.speed_at_start_mps;
  for (const Leg& leg : plan.legs) {
    drive_leg(leg_speeds(path, leg, plan.limits, speed), leg, step_s, s);
    rest(s, leg.to_m, leg.rest_s);
    speed = 0.0;
  }
  return smoothed(s, step_s);
}

}  // namespace slamd::sim
