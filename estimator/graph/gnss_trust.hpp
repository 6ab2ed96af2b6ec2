#pragma once
// Whether the receiver as a whole is to be believed: a latch that falls after it failed for some time and rises only after
// it has been good for longer. Sees verdicts on single fixes, no positions.
// In the manner of PX4 EKF2's GPS checks and time-outs.

#include <cstdint>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

enum class GnssTrust : std::uint8_t {
  kAbsent,    // no fix for long
  kStarting,  // not yet good for long enough
  kTrusted,
  kDoubtful,  // failing, not yet for long
  kFaulty,    // failed for too long: every fix is refused until it has been good again for good_s
};

const char* name(GnssTrust trust);

struct GnssTrustConfig {
  double absent_s = 5.0;
  double good_s = 8.0;     // in a row, before it is trusted, at first and again
  double faulty_s = 6.0;   // of failing, then it is faulty
};

class GnssTrustLatch {
 public:
  explicit GnssTrustLatch(const GnssTrustConfig& config) : config_{config} {}

  /// The verdict on one fix on its own. Returns whether it may be used.
  bool judge(HostTime time, bool good);
  GnssTrust trust(HostTime now) const;
  std::uint64_t times_faulty() const { return times_faulty_; }

 private:
  GnssTrustConfig config_;
  GnssTrust trust_ = GnssTrust::kStarting;
  std::optional<HostTime> last_;
  std::optional<HostTime> good_since_, bad_since_;
  std::uint64_t times_faulty_ = 0;
};

}  // namespace slamd
