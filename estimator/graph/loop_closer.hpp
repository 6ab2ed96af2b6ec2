#pragma once
// Finds earlier visits of where the vehicle is and says, by stages that each can refuse, how the two fit together. Solves
// no graph: what it accepts is a LoopSource's closures.

#include "estimator/graph/closure_consistency.hpp"
#include "estimator/graph/keyframe_clouds.hpp"
#include "estimator/graph/loop_closer_config.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/place_check.hpp"
#include "estimator/graph/place_descriptor.hpp"

namespace slamd {

class LoopCloser final : public LoopSource {
 public:
  /// p_base_lidar  where the rays begin, base frame, metres
  LoopCloser(const LoopCloserConfig& config, const Eigen::Vector3d& p_base_lidar);

  void add(const Keyframe& keyframe) override;
  void restore(const Keyframe& keyframe, std::vector<std::uint8_t> packed) override;
  void restore(const GraphView& view, std::span<const LoopClosure> closures) override;
  std::span<const std::uint8_t> packed(std::size_t keyframe) const override { return clouds_.packed(keyframe); }
  bool update(const GraphView& view, const Cancelled& cancelled = {}) override;
  std::span<const LoopClosure> closures() const override { return closures_; }
  void weigh(std::span<const double> weights) override;
  std::span<const LoopCandidateReport> reports() const override { return reports_; }
  std::optional<Recognition> recognise(const GraphView& view, const PieceView& piece,
                                       const std::optional<PlaceBelief>& belief) override;
  std::size_t forgotten() const override { return clouds_.forgotten(); }
  std::size_t bytes() const override;

  enum class Guess { kByOdometry, kSamePlace };

  /// Looks at one pair whatever the search would say of it, and takes the closure in when every stage agrees. For tests
  /// that put wrong candidates in. kSamePlace: as if the two had been found to look alike. Returns its verdict.
  LoopStage try_pair(const GraphView& view, std::uint64_t from, std::uint64_t to, Guess guess = Guess::kByOdometry);

 private:
  /// A pair of keyframes that may see the same place.
  struct Candidate {
    std::size_t from = 0;
    std::size_t to = 0;
    PlaceGuess guess;
    LoopCandidateReport report;
  };
  /// A closure that passed all stages but consistency, and what became of it.
  struct Passed {
    LoopClosure closure;
    std::size_t report = 0;   // index into reports_
    std::uint32_t doubts = 0;  // solves in a row in which the graph did not believe it
    bool retracted = false;
  };

  void append(const Keyframe& keyframe);
  void describe_restored(const GraphView& view);
  void describe_place(const GraphView& view, std::size_t keyframe);
  std::optional<std::size_t> nearest_place(const GraphView& view, const PlaceBelief& belief) const;
  void look_from(const GraphView& view, std::size_t to);
  template <class Eligible>
  std::vector<PlaceMatch> ranked_places(const PlaceDescriptor& here, Eligible&& eligible) const;
  std::vector<Candidate> near_candidates(const GraphView& view, std::size_t to) const;
  std::vector<Candidate> look_alikes(const GraphView& view, std::size_t to, double radius_m) const;
  Candidate look_alike(const GraphView& view, std::size_t from, std::size_t to, const PlaceMatch& match) const;
  bool is_loop(const GraphView& view, std::size_t from, std::size_t to) const;
  bool is_held_by_odometry(const GraphView& view, std::size_t from, std::size_t to) const;
  Candidate candidate(const GraphView& view, std::size_t from, std::size_t to) const;
  LoopStage verify(const GraphView& view, Candidate& candidate);
  void take_in(const GraphView& view, const LoopClosure& closure, LoopCandidateReport report);
  void collect();

  LoopCloserConfig config_;
  KeyframeClouds clouds_;
  std::vector<double> driven_m_;              // up to each keyframe
  std::vector<std::uint32_t> pieces_;         // of odometry, each with a local map of its own; one a keyframe
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero();
  std::vector<std::size_t> places_;           // keyframes that have a descriptor
  std::vector<PlaceDescriptor> descriptors_;  // of places_
  std::size_t restored_ = 0;                  // keyframes of an earlier run that have no descriptor yet: up to here
  std::size_t next_ = 0;                      // keyframe to look from
  AgreementGraph agreement_;
  std::vector<Passed> passed_;                // nodes of agreement_
  std::vector<LoopClosure> closures_;
  std::vector<std::size_t> believed_;         // index into passed_ of each of closures_
  std::vector<LoopCandidateReport> reports_;
};

}  // namespace slamd
