#pragma once
// The newest value of a trivially copyable struct, from one writer thread to any number of readers: older values are
// written over unseen, and the writer never waits. Not a queue. Types with Eigen members: see triple_buffer.hpp.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <optional>
#include <type_traits>

#include "daemon/ring/nonblocking.hpp"
#include "daemon/ring/seqlock.hpp"

namespace slamd {

template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T>);

 public:
  /// Writer only. Wait-free, no allocation.
  void store(const T& value) SLAMD_NONBLOCKING {
    typename Block::Words words{};
    std::memcpy(words.data(), &value, sizeof(T));
    block_.store(words);
  }

  /// Any thread but a real-time one, which might wait here for the writer: one that was put to sleep inside store() is waited for.
  /// The newest value; nullopt before the first store(), or after a second of waiting. Costs about as much as copying T twice.
  std::optional<T> load() const {
    constexpr int kNaps = 1000;
    constexpr timespec kNap{0, 1'000'000};
    typename Block::Words words;
    for (int naps = 0; !block_.load(words); ++naps) {
      if (!block_.begun() || naps == kNaps) return std::nullopt;
      clock_nanosleep(CLOCK_MONOTONIC, 0, &kNap, nullptr);
    }
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    return value;
  }

 private:
  using Block = Seqlock<(sizeof(T) + 7) / 8>;
  Block block_;
};

}  // namespace slamd
