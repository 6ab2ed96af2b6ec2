#include "tools/slam-eval/tables/drawn_path.hpp"

#include "tools/slam-eval/alignment.hpp"

namespace slamd::eval {

DrawnPath path_by_error(const MatchedPoses& matched) {
  const std::vector<Pose> truth = aligned(fit(Alignment::kSe3Umeyama, matched.estimate, matched.truth), matched.truth);
  DrawnPath drawn;
  drawn.path.values = ape(truth, matched.estimate, PoseRelation::kTranslationPart);
  drawn.path.range = plot::colour_range(drawn.path.values);
  drawn.ape = statistics(drawn.path.values);
  for (const Pose& pose : matched.estimate) drawn.path.points.push_back({pose.translation.x(), pose.translation.y()});
  for (const Pose& pose : truth) drawn.truth.push_back({pose.translation.x(), pose.translation.y()});
  return drawn;
}

}  // namespace slamd::eval
