#pragma once
// Durations counted in fixed buckets, two percent wide, from 1 ns to 68 s: written by one (also real-time) thread, read
// by any. Keeps no single value but the largest, and never forgets.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/ring/nonblocking.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct Percentiles {
  std::uint64_t count = 0;
  Duration p50{}, p90{}, p99{}, p999{}, max{};  // at most 1.6 % below or above the true ones; max is exact
};

class Histogram {
 public:
  /// Writer only. Wait-free; negative durations count as zero, longer ones as the last bucket.
  void record(Duration duration) SLAMD_NONBLOCKING;

  /// Any thread.
  Percentiles percentiles() const;
  /// Any thread. Durations up to each of the limits (to 3 %), which grow; and the sum of all.
  std::vector<std::uint64_t> counts_up_to(std::span<const Duration> limits) const;
  Duration sum() const { return Duration{static_cast<std::int64_t>(sum_ns_.load(std::memory_order_relaxed))}; }

 private:
  static constexpr int kSubBits = 5;                                  // 32 buckets an octave
  static constexpr int kOctaves = 36;                                 // 2^36 ns = 68 s
  static constexpr std::size_t kBuckets = (kOctaves - kSubBits + 1) << kSubBits;

  static std::size_t bucket(std::uint64_t ns);
  static std::uint64_t middle_ns(std::size_t bucket);

  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
  std::atomic<std::uint64_t> max_ns_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
};

}  // namespace slamd
