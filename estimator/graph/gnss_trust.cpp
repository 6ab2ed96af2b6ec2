#include "estimator/graph/gnss_trust.hpp"

namespace slamd {

const char* name(GnssTrust trust) {
  switch (trust) {
    case GnssTrust::kAbsent: return "absent";
    case GnssTrust::kStarting: return "starting";
    case GnssTrust::kTrusted: return "trusted";
    case GnssTrust::kDoubtful: return "doubtful";
    case GnssTrust::kFaulty: return "faulty";
  }
  return "?";
}

bool GnssTrustLatch::judge(HostTime time, bool good) {
  const bool gap = last_ && time - *last_ > from_seconds(config_.absent_s);
  last_ = time;
  if (gap) good_since_.reset();
  if (good) {
    bad_since_.reset();
    if (!good_since_) good_since_ = time;
    const bool earned = time - *good_since_ >= from_seconds(config_.good_s);
    if (earned || trust_ == GnssTrust::kDoubtful) trust_ = GnssTrust::kTrusted;
    return trust_ == GnssTrust::kTrusted;
  }
  good_since_.reset();
  if (!bad_since_) bad_since_ = time;
  const bool too_long = time - *bad_since_ >= from_seconds(config_.faulty_s);
  if (too_long && trust_ != GnssTrust::kFaulty) {
    trust_ = GnssTrust::kFaulty;
    ++times_faulty_;
  }
  if (trust_ == GnssTrust::kTrusted) trust_ = GnssTrust::kDoubtful;
  return false;
}

GnssTrust GnssTrustLatch::trust(HostTime now) const {
  const bool absent = !last_ || now - *last_ > from_seconds(config_.absent_s);
  return absent ? GnssTrust::kAbsent : trust_;
}

}  // namespace slamd
