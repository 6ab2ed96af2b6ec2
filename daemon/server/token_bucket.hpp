#pragma once
// A rate limit with a short burst: one token a request. Reads no clock.

#include <algorithm>

#include "estimator/types/time.hpp"

namespace slamd {

class TokenBucket {
 public:
  explicit TokenBucket(double rate_per_s) : rate_per_s_{rate_per_s}, tokens_{burst()} {}

  /// False when the rate is used up.
  bool take(HostTime now) {
    if (last_ != HostTime{}) tokens_ = std::min(burst(), tokens_ + to_seconds(now - last_) * rate_per_s_);
    last_ = now;
    if (tokens_ < 1.0) return false;
    tokens_ -= 1.0;
    return true;
  }

  /// After take() said no: how long until it will say yes.
  Duration wait() const { return from_seconds((1.0 - tokens_) / rate_per_s_) + Duration{1000}; }

 private:
  double burst() const { return std::max(1.0, rate_per_s_ / 4); }

  double rate_per_s_;
  double tokens_;
  HostTime last_;
};

}  // namespace slamd
