#pragma once
// When the points of a cloud were measured, and with which laser where the cloud does not say: from its time field whatever its unit,
// else from the azimuth. Reads no message.

#include <optional>
#include <vector>

#include "estimator/types/time.hpp"
#include "tools/slam-replay/bag/cloud_fields.hpp"

namespace slamd::replay {

/// How the clouds of one topic are timed.
struct CloudTimingConfig {
  bool stamp_is_begin = false;  // of clouds without time field: the header's stamp is the sweep's begin, not its end
  double period_s = 0.1;        // of a sweep
};

/// Seconds after the header's stamp, of each point.
/// stamp_ns  of the header, against which absolute times are taken
std::vector<double> point_times(const CloudPoints& cloud, std::int64_t stamp_ns, const CloudTimingConfig& config);

/// The lasers' elevations, learnt from one cloud without ring field.
class RingFinder {
 public:
  explicit RingFinder(const std::vector<CloudPoint>& points);
  std::uint8_t ring(const CloudPoint& point) const;

 private:
  std::vector<float> centres_rad_;  // rising
};

}  // namespace slamd::replay
