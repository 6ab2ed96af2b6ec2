#pragma once
// The loop closer with wrong candidates put among its own: a test of its stages on real keyframes. It decides nothing, every
// candidate goes through the stages of LoopCloser.

#include <random>

#include "estimator/graph/loop_closer.hpp"

namespace slamd::replay {

class InjectedLoops final : public LoopSource {
 public:
  /// share  of the places looked at that also get a wrong candidate, 0..1
  InjectedLoops(LoopCloser closer, double share) : closer_{std::move(closer)}, share_{share} {}

  void add(const Keyframe& keyframe) override { closer_.add(keyframe); }
  bool update(const GraphView& view, const Cancelled& cancelled = {}) override;
  std::span<const LoopClosure> closures() const override { return closer_.closures(); }
  void weigh(std::span<const double> weights) override { closer_.weigh(weights); }
  std::span<const LoopCandidateReport> reports() const override { return closer_.reports(); }

 private:
  LoopCloser closer_;
  double share_;
  std::mt19937_64 random_{1};
  std::size_t next_ = 0;
};

}  // namespace slamd::replay
