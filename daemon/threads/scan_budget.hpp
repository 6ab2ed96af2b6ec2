#pragma once
// How many of a scan's points may be worked on when the estimator is late: all, fewer, none. A pure function; it measures
// no time and drops nothing itself.

#include <cstdint>

#include "estimator/types/time.hpp"

namespace slamd {

struct ScanBudgetConfig {
  Duration late = std::chrono::milliseconds{60};       // up to here all points
  Duration hopeless = std::chrono::milliseconds{200};  // from here on the scan is let go: a fresher one is on its way already
};

/// Of the points of a scan that might have been worked on `lateness` ago (the newest event's arrival and the hold-back), 0..1: 1 when on time, then less the later, 0.25 at
/// least; 0 when the scan is to be let go.
double scan_share(const ScanBudgetConfig& config, Duration lateness);

/// A scan that got less than all, on its way to the recording: a replay gives it the same.
struct LimitedScan {
  HostTime end;
  double share = 1.0;
};

}  // namespace slamd
