#include "daemon/threads/scan_budget.hpp"

#include <algorithm>

namespace slamd {

double scan_share(const ScanBudgetConfig& config, Duration lateness) {
  constexpr double kLeast = 0.25;  // some 900 segments: still every direction that a full scan constrains
  if (lateness <= config.late) return 1.0;
  if (lateness >= config.hopeless) return 0.0;
  const double way = to_seconds(lateness - config.late) / to_seconds(config.hopeless - config.late);
  return std::max(kLeast, 1.0 - way);
}

}  // namespace slamd
