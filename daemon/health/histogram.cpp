#include "daemon/health/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace slamd {

// Below 2^kSubBits a bucket holds one nanosecond; above, each octave is cut into 2^kSubBits equal parts.
std::size_t Histogram::bucket(std::uint64_t ns) {
  const int shift = std::max(0, static_cast<int>(std::bit_width(ns)) - 1 - kSubBits);
  const std::size_t index = (static_cast<std::size_t>(shift) << kSubBits) + static_cast<std::size_t>(ns >> shift);
  return std::min(index, kBuckets - 1);
}

std::uint64_t Histogram::middle_ns(std::size_t bucket) {
  const std::size_t octave = bucket >> kSubBits;
  if (octave == 0) return bucket;
  const std::size_t shift = octave - 1;
  const std::uint64_t lowest = static_cast<std::uint64_t>(bucket - (shift << kSubBits)) << shift;
  return lowest + ((std::uint64_t{1} << shift) / 2);
}

void Histogram::record(Duration duration) SLAMD_NONBLOCKING {
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(duration.count(), 0));
  std::atomic<std::uint64_t>& count = counts_[bucket(ns)];
  count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  sum_ns_.store(sum_ns_.load(std::memory_order_relaxed) + ns, std::memory_order_relaxed);
  if (ns > max_ns_.load(std::memory_order_relaxed)) max_ns_.store(ns, std::memory_order_relaxed);
}

std::vector<std::uint64_t> Histogram::counts_up_to(std::span<const Duration> limits) const {
  std::vector<std::uint64_t> totals;
  std::uint64_t total = 0;
  std::size_t next = 0;
  for (const Duration limit : limits) {
    const std::size_t end = bucket(static_cast<std::uint64_t>(std::max<std::int64_t>(limit.count(), 0))) + 1;
    for (; next < end; ++next) total += counts_[next].load(std::memory_order_relaxed);
    totals.push_back(total);
  }
  return totals;
}

Percentiles Histogram::percentiles() const {
  std::array<std::uint64_t, kBuckets> counts;
  Percentiles result;
  for (std::size_t i = 0; i < kBuckets; ++i) {
    counts[i] = counts_[i].load(std::memory_order_relaxed);
    result.count += counts[i];
  }
  result.max = Duration{static_cast<std::int64_t>(max_ns_.load(std::memory_order_relaxed))};
  if (result.count == 0) return result;
  const auto quantile = [&](double share) {
    const double wanted = std::ceil(share * static_cast<double>(result.count));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      below += counts[i];
      if (static_cast<double>(below) >= wanted) {
        return std::min(Duration{static_cast<std::int64_t>(middle_ns(i))}, result.max);
      }
    }
    return result.max;
  };
  result.p50 = quantile(0.5);
  result.p90 = quantile(0.9);
  result.p99 = quantile(0.99);
  result.p999 = quantile(0.999);
  return result;
}

}  // namespace slamd
