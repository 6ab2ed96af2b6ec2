#include "daemon/service/watchdog.hpp"

#include <algorithm>
#include <utility>

namespace slamd {

void Watchdog::watch(std::string part, Progress progress) {
  const std::uint64_t count = progress();
  parts_.push_back({std::move(part), std::move(progress), count, false});
}

bool Watchdog::look(HostTime now) {
  for (Part& part : parts_) part.moved = part.progress() != part.fed_with;
  const bool all_moved = std::all_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.moved; });
  if (!all_moved || now - fed_at_ < period_ / 4) return false;
  for (Part& part : parts_) part.fed_with = part.progress();
  fed_at_ = now;
  return true;
}

std::string Watchdog::stuck(HostTime now) const {
  if (now - fed_at_ <= period_ / 2) return {};
  const auto found = std::find_if(parts_.begin(), parts_.end(), [](const Part& part) { return !part.moved; });
  return found != parts_.end() ? found->name : std::string{};
}

}  // namespace slamd
