#include "tools/slam-sim/motion/traffic.hpp"

#include <cmath>
#include <numbers>

#include "tools/slam-sim/world/rng.hpp"

namespace slamd::sim {

Traffic::Traffic(const World& world, const Trajectory& ego, const Path& ego_path, int count, std::uint64_t seed)
    : ground_{world.ground},
      ego_{ego},
      ego_path_{std::make_unique<Path>(ego_path)},
      oncoming_{std::make_unique<Path>(world.oncoming)},
      pavement_{std::make_unique<Path>(world.pavement)} {
  Rng rng{seed, Stream::kTraffic};
  const auto paint = [&] { return Material{static_cast<float>(rng.uniform(0.08, 0.6))}; };
  for (int i = 0; i < count; ++i) {
    if (i == 9) {
      movers_.push_back({ego_path_.get(), 13.0, 0.0, 0.0, true, {2.2, 0.9, 0.72}, paint()});
    } else if (i % 3 == 0) {
      const double van = rng.chance(0.25) ? 1.2 : 0.72;
      movers_.push_back({oncoming_.get(),
                         rng.uniform(0.0, oncoming_->length()),
                         -rng.uniform(4.0, 9.0),
                         rng.uniform(-0.2, 0.2),
                         false,
                         {rng.uniform(1.9, 2.7), 0.9, van},
                         paint()});
    } else {
      const double speed = rng.uniform(0.8, 1.7) * (rng.chance(0.5) ? 1.0 : -1.0);
      movers_.push_back({pavement_.get(),
                         rng.uniform(0.0, pavement_->length()),
                         speed,
                         rng.uniform(-0.5, 0.5),
                         false,
                         {0.18, 0.25, rng.uniform(0.78, 0.95)},
                         materials::kClothes});
    }
  }
}

double Traffic::distance(const Mover& mover, double t) const {
  if (mover.follows_ego) return ego_.distance_at(t) + mover.start_m;
  const double length = mover.path->length();
  const double s = std::fmod(mover.start_m + mover.speed_mps * t, length);
  return s < 0.0 ? s + length : s;
}

MovingBody Traffic::body_of(const Mover& mover, double t) const {
  const auto place = [&](double s) {
    const PathPoint at = mover.path->at(s);
    const Eigen::Vector2d p = at.position + mover.lateral_m * Eigen::Vector2d(-std::sin(at.yaw), std::cos(at.yaw));
    const double clearance = mover.half.z() > 0.6 && mover.half.x() > 1.0 ? 0.2 : 0.0;
    return Eigen::Vector3d(p.x(), p.y(), ground_.height(p.x(), p.y()) + mover.half.z() + clearance);
  };
  constexpr double kStep = 0.02;
  const double s = distance(mover, t);
  const double speed =
      mover.follows_ego ? (ego_.distance_at(t + kStep) - ego_.distance_at(t)) / kStep : mover.speed_mps;
  const Eigen::Vector3d here = place(s);
  const Eigen::Vector3d velocity = (place(s + speed * kStep) - here) / kStep;
  const double turn = mover.speed_mps < 0.0 ? std::numbers::pi : 0.0;
  return {make_box(here, mover.half, mover.path->at(s).yaw + turn, mover.material), velocity};
}

std::vector<MovingBody> Traffic::at(double t, const Eigen::Vector3d& near, double reach_m) const {
  std::vector<MovingBody> bodies;
  for (const Mover& mover : movers_) {
    const Eigen::Vector2d rough = mover.path->at(distance(mover, t)).position;
    if ((rough - near.head<2>()).norm() < reach_m) bodies.push_back(body_of(mover, t));
  }
  return bodies;
}

}  // namespace slamd::sim
