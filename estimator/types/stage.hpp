#pragma once
// The steps that one scan takes, and who is told when each is done. The estimator reads no clock: a listener may.

#include <cstddef>
#include <cstdint>

namespace slamd {

enum class Stage : std::uint8_t {
  kPropagate,  // IMU samples to the scan's end
  kDeskew,     // back-propagation and choice of points
  kAssociate,  // planes of the points
  kSolve,      // residuals and the filter's update
  kInsert,     // points into the map, re-balancing
  kKeyframe,   // points for the back end
};
inline constexpr std::size_t kStages = 6;

/// "propagate", "deskew", ...
const char* name(Stage stage);

class StageListener {
 public:
  virtual ~StageListener() = default;
  /// All work since the previous call, or since the scan was begun, was for `stage`. Called on the estimator's thread.
  virtual void finished(Stage stage) = 0;
};

}  // namespace slamd
