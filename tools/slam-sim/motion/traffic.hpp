#pragma once
// Cars and pedestrians on the move: boxes that follow paths. They touch nothing and nobody touches them.

#include <memory>
#include <vector>

#include "tools/slam-sim/motion/trajectory.hpp"

namespace slamd::sim {

/// One mover at one moment, as a ray sees it.
struct MovingBody {
  Primitive body;
  Eigen::Vector3d velocity;
};

class Traffic {
 public:
  /// `count` movers: a third oncoming cars, the rest pedestrians, and (from 10 on) a car that keeps ahead of the ego.
  Traffic(const World& world, const Trajectory& ego, const Path& ego_path, int count, std::uint64_t seed);

  /// Those within reach_m of `near` at time t. Thread-safe.
  std::vector<MovingBody> at(double t, const Eigen::Vector3d& near, double reach_m) const;

 private:
  struct Mover {
    const Path* path;
    double start_m;
    double speed_mps;  // negative: against the path's direction
    double lateral_m;  // to the left of the path
    bool follows_ego;  // start_m ahead of the ego, at its speed
    Eigen::Vector3d half;
    Material material;
  };
  double distance(const Mover& mover, double t) const;
  MovingBody body_of(const Mover& mover, double t) const;

  const HeightField& ground_;
  const Trajectory& ego_;
  std::unique_ptr<Path> ego_path_, oncoming_, pavement_;
  std::vector<Mover> movers_;
};

}  // namespace slamd::sim
