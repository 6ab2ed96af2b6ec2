#pragma once
// What a search for loops hands to the graph, and what it says of each candidate. The search itself is a LoopSource.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "estimator/graph/graph_solution.hpp"
#include "estimator/graph/odometry_chain.hpp"
#include "estimator/graph/place_recognition.hpp"
#include "estimator/types/keyframe.hpp"

namespace slamd {

/// An accepted closure between two keyframes.
struct LoopClosure {
  std::uint64_t from = 0;  // the earlier keyframe
  std::uint64_t to = 0;    // the later one
  Pose T_from_to;          // measured by registration
  /// Of T_from_to, as Keyframe::relative_covariance: T_true = T_from_to * Exp(e), rows translation, then rotation, in the
  /// base of `to`. Directions that the registration did not constrain have a large variance (metres, radians), never
  /// infinity or a singular matrix.
  Matrix6d covariance = Matrix6d::Identity();
};

/// The stages that a candidate passes, in this order. Numbers are those of closures.csv and never reused.
enum class LoopStage : std::uint8_t {
  kSearch = 0,        // the view from above finds no place for it, or several that fit equally well
  kRegistration = 1,  // fitness: share of inliers
  kOverlap = 2,       // share of the sub-map that the other one sees
  kFreeSpace = 3,     // share of rays that pass through a surface of the other
  kOdometry = 4,      // chi2 against the odometry's covariance
  kConsistency = 5,   // not in the largest set of closures that agree with each other
  kGraph = 6,         // accepted, then contradicted by the rest of the graph and retracted
  kAccepted = 7,
};

/// Every number that a stage judged; NaN where the candidate did not come so far.
struct LoopCandidateReport {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
  LoopStage ended_at = LoopStage::kSearch;  // the stage that said no; kAccepted: none did
  bool by_appearance = false;               // found by descriptor; false: by distance
  double distance_m = 0.0;                  // between the poses as the graph had them
  double descriptor_distance = 0.0;
  double fitness = 0.0;
  double overlap = 0.0;
  double free_space_share = 0.0;
  double odometry_chi2 = 0.0;               // 6 degrees of freedom
  double consistency_chi2 = 0.0;            // worst against the closures that it agrees with
  double graph_weight = 0.0;                // robust weight after the newest solve, 0..1
  Pose T_from_to;                           // as registered; where registration did not come to an end, as guessed
};

/// What a source may look at: all keyframes by id (as the graph believes them now) and the front end's chain.
struct GraphView {
  std::span<const KeyframeEstimate> keyframes;
  const OdometryChain& odometry;
};

/// Asked often by a work that is long; true = stop soon. Empty: never.
using Cancelled = std::function<bool()>;

/// Finds and verifies closures. Called by the mapper alone, one thread; deterministic.
class LoopSource {
 public:
  virtual ~LoopSource() = default;
  /// A new keyframe with its points. Cheap (below 0.5 ms): searching is for update().
  virtual void add(const Keyframe& keyframe) = 0;
  /// A keyframe of an earlier run: its points are those that packed() gave then. Not looked at for closures by itself.
  virtual void restore(const Keyframe& keyframe, std::vector<std::uint8_t> packed) {
    static_cast<void>(packed);
    add(keyframe);
  }
  /// After those: the closures of then between them, which hold as if they had been found now.
  virtual void restore(const GraphView& view, std::span<const LoopClosure> closures) {
    static_cast<void>(view), static_cast<void>(closures);
  }
  /// A keyframe's points for restore(); empty when it has none any more.
  virtual std::span<const std::uint8_t> packed(std::size_t keyframe) const {
    static_cast<void>(keyframe);
    return {};
  }
  /// Looks at keyframes that were not looked at so far; when cancelled at one of them at least, at the others the next
  /// time. True when closures() is another set than before.
  virtual bool update(const GraphView& view, const Cancelled& cancelled = {}) = 0;
  /// All closures that hold now: what is missing here is not in the graph any more.
  virtual std::span<const LoopClosure> closures() const = 0;
  /// After each solve: robust weight of each of closures(), in their order, 0 = contradicted by the rest, 1 = fits. The
  /// source decides what to retract; it is gone from closures() after the next update().
  virtual void weigh(std::span<const double> weights) = 0;
  /// Where in the map the newest keyframe of `piece` is: where it is believed to be when that is given, else by looks among all places.
  /// Verified as closures are, but not against any odometry. None: nothing fits, or more than one place does.
  virtual std::optional<Recognition> recognise(const GraphView& view, const PieceView& piece,
                                               const std::optional<PlaceBelief>& belief) {
    static_cast<void>(view), static_cast<void>(piece), static_cast<void>(belief);
    return std::nullopt;
  }
  /// So many of the oldest keyframes no loop can be closed with any more.
  virtual std::size_t forgotten() const { return 0; }
  /// Of memory that grows with the drive; what has a budget of its own is not in it.
  virtual std::size_t bytes() const { return 0; }
  /// One a candidate, in order of `to`, with its newest verdict.
  virtual std::span<const LoopCandidateReport> reports() const = 0;
};

}  // namespace slamd
