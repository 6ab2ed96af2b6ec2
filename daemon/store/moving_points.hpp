#pragma once
// Finds points of moving objects: those that rays of other keyframes, shortly before or after, went through. Works on
// recent keyframes in odom, a bounded amount for each new one; what has left its window keeps what it has.

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "daemon/store/packed_point.hpp"
#include "daemon/store/ray_image.hpp"

namespace slamd {

struct MovingPointsConfig {
  std::uint32_t keyframes = 24;      // that bear witness on a point after its own; 0: nothing is ever removed
  std::uint8_t fewest_witnesses = 3;  // that a ray went through, before a point is removed
};

class MovingPoints {
 public:
  /// A keyframe that lost points.
  struct Verdict {
    std::uint64_t id = 0;
    Pose T_odom_base;
    PackedPoints kept, removed;
  };

  MovingPoints(const MovingPointsConfig& config, const Pose& T_base_lidar);

  /// points  what is kept of the keyframe's points.
  /// Returns those keyframes, this one among them, of which points turned out to be of moving objects.
  std::vector<Verdict> add(const Keyframe& keyframe, const PackedPoints& points);

 private:
  struct Tally {
    std::array<std::int8_t, 3> normal{};  // base frame, in 1/127; zero when unknown
    std::uint8_t seen = 0, passed = 0;
  };
  struct Suspects {
    std::uint64_t id = 0;
    Pose T_odom_base;
    PackedPoints points;
    std::vector<Tally> tallies;  // of the points
  };
  struct Drawn {
    Pose T_odom_lidar;
    std::shared_ptr<RayImage> image;
  };

  Suspects make_suspects(const Keyframe& keyframe, const PackedPoints& points, const RayImage& own) const;
  void question(const Drawn& witness, Suspects& suspects) const;
  bool is_moving(const Tally& tally) const;
  void judge(Suspects& suspects, std::vector<Verdict>& verdicts) const;
  std::shared_ptr<RayImage> fresh_image();

  MovingPointsConfig config_;
  Pose T_base_lidar_;
  std::deque<Suspects> recent_;
  std::deque<Drawn> drawn_;  // every kDrawnStride-th of them
  std::uint64_t added_ = 0;
};

}  // namespace slamd
