#include "estimator/types/stage.hpp"

namespace slamd {

const char* name(Stage stage) {
  switch (stage) {
    case Stage::kPropagate: return "propagate";
    case Stage::kDeskew: return "deskew";
    case Stage::kAssociate: return "associate";
    case Stage::kSolve: return "solve";
    case Stage::kInsert: return "insert";
    case Stage::kKeyframe: return "keyframe";
  }
  return "?";
}

}  // namespace slamd
