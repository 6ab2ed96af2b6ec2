#pragma once
// The newest value of any copyable type, from one writer thread to one reader thread: older values are written over
// unseen, and neither side ever waits or retries. Not for several readers (latest_value.hpp).

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "daemon/ring/nonblocking.hpp"

namespace slamd {

template <class T>
class TripleBuffer {
 public:
  /// Writer only. The slot to fill in place; it holds some older value. Becomes visible with publish().
  T& back() SLAMD_NONBLOCKING { return slots_[back_]; }

  /// Writer only. Makes back() the newest value.
  void publish() SLAMD_NONBLOCKING {
    // acq_rel: hands the filled slot over, and takes back one that the reader has finished with.
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }

  /// Writer only. Copies the value in and publishes it.
  void store(const T& value) {
    back() = value;
    publish();
  }

  /// Reader only. The newest value, to be read in place until the next call; nullptr before the first publish().
  const T* load() SLAMD_NONBLOCKING {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
      seen_ = true;
    }
    return seen_ ? &slots_[front_] : nullptr;
  }

 private:
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::uint8_t kIndex = 3;

  std::array<T, 3> slots_{};
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t back_ = 0;   // the writer's slot
  alignas(64) std::uint8_t front_ = 2;  // the reader's slot
  bool seen_ = false;
};

}  // namespace slamd
