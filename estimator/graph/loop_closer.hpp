#pragma once
// Finds earlier visits of where the vehicle is and says, by stages that each can refuse, how the two fit together. Solves
// no graph: what it accepts is a LoopSource's closures.

#include "estimator/graph/bird_view.hpp"
#include "estimator/graph/closure_consistency.hpp"
#include "estimator/graph/free_space.hpp"
#include "estimator/graph/keyframe_clouds.hpp"
#include "estimator/graph/loop_closure.hpp"
#include "estimator/graph/place_descriptor.hpp"
#include "estimator/graph/submap_registration.hpp"

namespace slamd {

struct LoopCloserConfig {
  KeyframeCloudsConfig clouds;
  SubmapRegistrationConfig registration;
  FreeSpaceConfig free_space;
  double radius_m = 20.0;                 // grows with the uncertainty of the pose
  std::uint32_t min_keyframes_back = 8;
  double min_detour_m = 20.0;             // driven in between, beyond three times the straight way: else it is no loop
  // Half the cube of the odometry's own map (set by the configuration from PlaneMapConfig::max_distance_m): a place that never
  // left it is still in that map, and the odometry has closed the loop itself, unless it lost its way by more than this sigma.
  double local_map_reach_m = 110.0;
  double max_held_sigma_m = 0.2;
  std::uint32_t search_every = 4;         // keyframes
  std::uint32_t keyframes_ahead = 4;      // that a place waits for, so that its sub-map is round
  std::uint32_t keyframes_behind = 8;
  std::uint32_t candidates_by_appearance = 2;
  double max_descriptor_distance = 0.6;
  double min_search_score = 0.35;         // of the view from above
  double max_runner_up = 0.92;            // of the best score: beyond, the place repeats itself
  double min_fitness = 0.5;
  double min_overlap = 0.4;
  double max_free_space_share = 0.06;
  double max_chi2 = 22.46;                // 6 degrees of freedom, 99.9 %
};

class LoopCloser final : public LoopSource {
 public:
  /// p_base_lidar  where the rays begin, base frame, metres
  LoopCloser(const LoopCloserConfig& config, const Eigen::Vector3d& p_base_lidar);

  void add(const Keyframe& keyframe) override;
  bool update(const GraphView& view) override;
  std::span<const LoopClosure> closures() const override { return closures_; }
  void weigh(std::span<const double> weights) override;
  std::span<const LoopCandidateReport> reports() const override { return reports_; }
  std::size_t forgotten() const override { return clouds_.forgotten(); }

  enum class Guess { kByOdometry, kSamePlace };

  /// Looks at one pair whatever the search would say of it, and takes the closure in when every stage agrees. For tests
  /// that put wrong candidates in. kSamePlace: as if the two had been found to look alike. Returns its verdict.
  LoopStage try_pair(const GraphView& view, std::uint64_t from, std::uint64_t to, Guess guess = Guess::kByOdometry);

 private:
  /// A pair of keyframes that may see the same place.
  struct Candidate {
    std::size_t from = 0;
    std::size_t to = 0;
    PlanarPose T_from_to;     // guess, level frames
    double height_m = 0.0;
    PlanarWindow window;      // around the guess
    LoopCandidateReport report;
  };
  /// A closure that passed all stages but consistency, and what became of it.
  struct Passed {
    LoopClosure closure;
    std::size_t report = 0;   // index into reports_
    std::uint32_t doubts = 0;  // solves in a row in which the graph did not believe it
    bool retracted = false;
  };

  void look_from(const GraphView& view, std::size_t to);
  std::vector<Candidate> near_candidates(const GraphView& view, std::size_t to) const;
  std::vector<Candidate> look_alikes(const GraphView& view, std::size_t to, double radius_m) const;
  Candidate look_alike(const GraphView& view, std::size_t from, std::size_t to, const PlaceMatch& match) const;
  bool is_loop(const GraphView& view, std::size_t from, std::size_t to) const;
  bool is_held_by_odometry(const GraphView& view, std::size_t from, std::size_t to) const;
  Candidate candidate(const GraphView& view, std::size_t from, std::size_t to) const;
  LoopStage verify(const GraphView& view, Candidate& candidate);
  bool guess(const Submap& target, const Submap& source, Candidate& candidate) const;
  void take_in(const GraphView& view, const LoopClosure& closure, LoopCandidateReport report);
  void collect();

  LoopCloserConfig config_;
  KeyframeClouds clouds_;
  std::vector<double> driven_m_;              // up to each keyframe
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero();
  std::vector<std::size_t> places_;           // keyframes that have a descriptor
  std::vector<PlaceDescriptor> descriptors_;  // of places_
  std::size_t next_ = 0;                      // keyframe to look from
  AgreementGraph agreement_;
  std::vector<Passed> passed_;                // nodes of agreement_
  std::vector<LoopClosure> closures_;
  std::vector<std::size_t> believed_;         // index into passed_ of each of closures_
  std::vector<LoopCandidateReport> reports_;
};

}  // namespace slamd
