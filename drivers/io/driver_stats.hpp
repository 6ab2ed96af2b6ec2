#pragma once
// Counters of what a driver took and of what it refused, by cause. Plain integers of one thread: whoever shows them to
// another thread publishes a copy.

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamd {

/// One counter for each value of Cause, an enum class that counts from 0 and ends with kCount and for which
/// `const char* name(Cause)` gives a short English name ("wrong_size") for reports.
template <class Cause>
class CauseCounters {
 public:
  static constexpr std::size_t kSize = static_cast<std::size_t>(Cause::kCount);

  void add(Cause cause, std::uint64_t count = 1) { counts_[static_cast<std::size_t>(cause)] += count; }
  std::uint64_t operator[](Cause cause) const { return counts_[static_cast<std::size_t>(cause)]; }

  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counts_) sum += count;
    return sum;
  }

  /// Calls visit(const char* name, std::uint64_t count) for every cause, zero counts included, in the enum's order.
  template <class Visitor>
  void for_each(Visitor&& visit) const {
    for (std::size_t i = 0; i < kSize; ++i) visit(name(static_cast<Cause>(i)), counts_[i]);
  }

 private:
  std::array<std::uint64_t, kSize> counts_{};
};

}  // namespace slamd
