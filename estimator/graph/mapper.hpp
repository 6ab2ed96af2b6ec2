#pragma once
// The back end's facade: keyframes and fixes in, snapshots of the corrected map out. One thread calls it; it starts none
// and reads no clock - whoever calls solve() says when it has taken long enough.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "estimator/graph/gnss_position.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/map_graph.hpp"
#include "estimator/graph/odometry_chain.hpp"
#include "estimator/types/stored_map.hpp"

namespace slamd {

struct MapperConfig {
  MapGraphConfig graph;
  int max_iterations = 30;     // of one solve
  double closure_growth = 0.01;  // the drive grows by this share between two solves that closures or GPS ask for
  double resolve_growth = 0.1;   // and by this one when only gravity does
  // Of all that grows with the drive but points: beyond it no keyframe and no fix is taken in any more, and later poses move
  // with the last one that was.
  std::size_t byte_budget = 512U * 1024 * 1024;
};

class Mapper {
 public:
  /// loops, positions  may be null: then there is none of that kind
  Mapper(const MapperConfig& config, std::unique_ptr<LoopSource> loops, std::unique_ptr<PositionSource> positions);

  /// Ids count from 0 without gaps; one that does not is ignored and counted, as is all beyond the byte budget. Bounded time, whatever the drive's length.
  void add(const Keyframe& keyframe);
  void add(const GnssFix& fix);

  /// The newest keyframes, of as many as their points take `byte_budget`, for a later run; none without a search for loops.
  StoredMap stored(std::size_t byte_budget) const;
  /// One keyframe that has come since, not the first.
  StoredStep stored_step(std::size_t keyframe) const;
  /// Begins with the keyframes of an earlier run instead of none: where they were left, as sure of it as the odometry and the closures
  /// of then. Their stamps are moved to end before `now`. Only on an empty mapper.
  void restore(StoredMap map, HostTime now);

  /// Searches for closures and solves the whole graph if a closure, GPS or growth asks for it, from where it is; so that the
  /// cost of a drive stays linear, not before the drive has grown by config.closure_growth. True when solution() is a new one. When cancelled, what was reached is kept for the next call but not published.
  bool solve(const Cancelled& cancelled = {});

  /// Solves whatever is open, to the end: for the last solution of a drive. True when there is one.
  bool finish();

  /// The newest snapshot; never null, and nobody changes it. Hand it to other threads freely.
  std::shared_ptr<const GraphSolution> solution() const { return solution_; }

  /// Of every keyframe, those after the newest solve chained by odometry.
  std::span<const KeyframeEstimate> keyframes() const { return keyframes_; }

  GraphView view() const { return {keyframes_, odometry_}; }
  /// As LoopSource::recognise in this map; none without a search for loops.
  std::optional<Recognition> recognise(const PieceView& piece, const std::optional<PlaceBelief>& belief) {
    return loops_ && !keyframes_.empty() ? loops_->recognise(view(), piece, belief) : std::nullopt;
  }

  /// Every candidate of the search for loops so far; empty without one.
  std::span<const LoopCandidateReport> loop_reports() const;
  /// As PositionSource::reports; empty without GPS.
  std::vector<FixReport> fix_reports() const;
  /// Keyframes that no loop can be closed with any more: their points were forgotten for the byte budget.
  std::size_t forgotten_clouds() const { return loops_ ? loops_->forgotten() : 0; }
  /// The side of GPS; null without.
  const PositionSource* positions() const { return positions_.get(); }
  std::uint64_t rejected_keyframes() const { return rejected_; }

  /// Estimate of what config.byte_budget bounds, the solver's share while it works included.
  std::size_t bytes() const;
  std::size_t byte_budget() const { return config_.byte_budget; }
  /// Keyframes not taken in for the budget: more than none, and the map is corrected no further.
  std::uint64_t left_out_keyframes() const { return left_out_; }

 private:
  void keep(const Keyframe& keyframe);
  std::vector<StoredClosure> stored_closures(std::size_t first) const;
  void restore_closures(std::span<const StoredClosure> closures);
  std::optional<StoredEnu> stored_enu() const;
  bool ask_sources(const Cancelled& cancelled);
  bool grown(double share, double at_least) const;
  bool solve_whole(const Cancelled& cancelled);
  void publish(const MapGraphSolve& solve);

  MapperConfig config_;
  std::unique_ptr<LoopSource> loops_;
  std::unique_ptr<PositionSource> positions_;
  MapGraph graph_;
  OdometryChain odometry_;
  std::vector<KeyframeEstimate> keyframes_;
  StoredSensors sensors_;  // as the newest keyframe has them
  StoredMotion motion_;    // likewise
  std::optional<EnuAlignment> enu_;  // as the newest solve left it
  std::optional<StoredEnu> restored_enu_;  // told until there is a newer one
  std::shared_ptr<const GraphSolution> solution_ = std::make_shared<GraphSolution>();
  bool pending_ = false;  // something asked for a solve that did not end yet
  std::uint64_t rejected_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace slamd
