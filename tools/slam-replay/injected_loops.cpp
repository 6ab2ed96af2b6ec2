#include "tools/slam-replay/injected_loops.hpp"

namespace slamd::replay {
namespace {

constexpr std::size_t kEvery = 4;    // keyframes, as the closer looks
constexpr std::size_t kAhead = 4;    // that the closer waits for
constexpr std::size_t kApart = 8;    // keyframes between the two of a pair, at least
constexpr double kElsewhere_m = 10.0;  // so far from each other two keyframes are not the same place

}  // namespace

/// Half of the wrong pairs come as two places that look alike, half as odometry has them.
bool InjectedLoops::update(const GraphView& view, const Cancelled& cancelled) {
  bool changed = closer_.update(view, cancelled);
  for (; next_ + kAhead < view.odometry.size(); next_ += kEvery) {
    const bool wanted = std::uniform_real_distribution<>{0.0, 1.0}(random_) < share_;
    if (!wanted || next_ < kApart) continue;
    const std::size_t from = std::uniform_int_distribution<std::size_t>{0, next_ - kApart}(random_);
    if (view.odometry.relative(from, next_).translation.norm() < kElsewhere_m) continue;
    const auto guess = random_() % 2 == 0 ? LoopCloser::Guess::kSamePlace : LoopCloser::Guess::kByOdometry;
    const std::size_t before = closer_.closures().size();
    closer_.try_pair(view, from, next_, guess);
    changed = changed || closer_.closures().size() != before;
  }
  return changed;
}

}  // namespace slamd::replay
