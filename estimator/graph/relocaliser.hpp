#pragma once
// Keeps one map over several pieces of odometry: a piece that begins without a link to the map is looked for in it, and
// nothing of the piece enters the map before it is found there. One thread; no clock.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "estimator/graph/map_link.hpp"
#include "estimator/graph/mapper.hpp"

namespace slamd {

struct RelocaliserConfig {
  double confirm_m = 4.0;      // a place found by looks alone counts when another one, so far on, says the same
  double agree_m = 0.5;        // of where odom lies in map
  double agree_rad = 0.02;
  std::uint32_t look_every = 2;     // keyframes of a piece that is looked for
  std::uint32_t max_waiting = 32;   // keyframes that wait for their place in map; beyond it the oldest are not mapped
  double patience_m = 300.0;   // driven without being found, then the map begins anew
  KeyframeCloudsConfig clouds; // of the piece
};

struct RelocaliserCounts {
  std::uint64_t relocalised = 0;   // pieces found again in the map
  std::uint64_t begun_anew = 0;    // maps given up for a piece that was not found
};

class Relocaliser {
 public:
  using MakeMapper = std::function<Mapper()>;

  /// make_mapper  gives an empty back end, now and whenever the map begins anew
  /// p_base_lidar  where the rays begin, base frame, metres
  Relocaliser(const RelocaliserConfig& config, MakeMapper make_mapper, const Eigen::Vector3d& p_base_lidar);

  /// Begins with the map of an earlier run, in which the vehicle is looked for first where it was left, or, when the map says how it
  /// moved (by the host clock of the keyframes), where that has brought it. When nothing of the map
  /// fits what the first keyframe sees, a new map begins. Before the first add(). now  host time
  void restore(StoredMap map, HostTime now);

  /// What a keyframe brings into the map.
  struct Entered {
    bool map_began_anew = false;          // all that was there before is gone
    std::span<const Keyframe> keyframes;  // ids without gaps, poses in the back end's own odom; valid until the next add()
  };
  Entered add(const Keyframe& keyframe);
  void add(const GnssFix& fix) { mapper_.add(fix); }

  /// The mapper may be asked to solve, not to add.
  Mapper& mapper() { return mapper_; }
  const Mapper& mapper() const { return mapper_; }

  /// Of the newest piece, by the mapper's newest solution.
  MapLink link() const;
  /// Odom of a piece in the back end's own odom; null for a piece that has no place in the map.
  std::optional<Pose> T_chain_odom(std::uint32_t odom_piece) const;
  const RelocaliserCounts& counts() const { return counts_; }

 private:
  /// A recognition, and where it puts the piece's odom.
  struct Found {
    Recognition recognition;
    Pose T_map_odom;
  };
  struct Link {
    std::uint32_t odom_piece;
    Pose T_chain_odom;
  };
  /// Where an earlier run left the vehicle, and how it moved there.
  struct Left {
    Pose T_map_base;
    std::optional<StoredMotion> motion;
  };

  void begin_piece(std::uint32_t odom_piece);
  /// Where a piece's first keyframe should be in map.
  PlaceBelief believed(const NavState& first) const;
  void wait(const Keyframe& keyframe);
  std::optional<Found> look();
  Found found(const Recognition& recognition) const;
  bool is_confirmed(const Found& newest) const;
  void join(const Found& place);
  double patience_m() const;
  Entered enter_waiting();
  void begin_anew();

  RelocaliserConfig config_;
  MakeMapper make_mapper_;
  Eigen::Vector3d p_base_lidar_;
  Mapper mapper_;
  std::vector<Link> links_;              // of pieces in the map; the newest one's is the last when it is known
  std::uint32_t odom_piece_ = 0;
  bool known_ = true;
  std::optional<Left> left_;             // the map is of an earlier run, and nothing of this one is in it yet
  PlaceBelief belief_;                   // of the piece's first keyframe
  OdometryChain piece_;
  KeyframeClouds clouds_;
  double driven_m_ = 0.0;
  std::vector<Found> by_looks_;
  std::vector<Keyframe> waiting_;        // the newest of piece_; entered ones until the next add()
  RelocaliserCounts counts_;
};

}  // namespace slamd
