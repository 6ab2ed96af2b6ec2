#include "drivers/io/receive_clock.hpp"

#include <cstdlib>
#include <ctime>

namespace slamd {
namespace {

constexpr std::int64_t kStepNs = 100'000;     // beyond any error of reading the clocks one after the other
constexpr std::int64_t kTightReadNs = 5'000;  // a longer bracket means we were interrupted between the readings
constexpr int kReadAttempts = 3;
constexpr std::int64_t kOldestStampNs = 10'000'000'000;  // a full receive buffer holds less

std::int64_t read_ns(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

void ReceiveClock::sample() {
  std::int64_t realtime = 0, before = 0, after = 0;
  for (int attempt = 0; attempt < kReadAttempts; ++attempt) {
    before = read_ns(CLOCK_MONOTONIC);
    realtime = read_ns(CLOCK_REALTIME);
    after = read_ns(CLOCK_MONOTONIC);
    if (after - before < kTightReadNs) break;
  }
  sample(realtime, from_ns<HostTime>(before + (after - before) / 2));
}

void ReceiveClock::sample(std::int64_t realtime_ns, HostTime now) {
  const std::int64_t offset = realtime_ns - to_ns(now);
  stepped_ = offset_ns_ && std::abs(offset - *offset_ns_) > kStepNs;
  offset_ns_ = offset;
  now_ = now;
  realtime_now_ns_ = realtime_ns;
}

std::optional<HostTime> ReceiveClock::arrival(std::int64_t realtime_stamp_ns) const {
  const std::int64_t age = realtime_now_ns_ - realtime_stamp_ns;
  if (stepped_ || age < -kTightReadNs || age > kOldestStampNs) return std::nullopt;
  return now_ - Duration{age};
}

}  // namespace slamd
