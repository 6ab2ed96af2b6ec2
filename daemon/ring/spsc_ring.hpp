#pragma once
// Ring from one producer thread to one consumer thread: when full the newest item is dropped and counted, and neither
// side ever blocks. Not a queue for many producers, and nothing wakes the consumer.

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "daemon/ring/nonblocking.hpp"

namespace slamd {

/// What a ring has seen since its construction; readable from any thread while both sides run.
struct RingCounts {
  std::size_t capacity = 0;
  std::size_t size = 0;
  std::size_t high_water = 0;  // most items that ever waited at once
  std::uint64_t pushed = 0;    // without the dropped ones
  std::uint64_t dropped = 0;
};

template <class T>
class SpscRing {
  static_assert(std::is_default_constructible_v<T>, "slots are constructed once and written over");

 public:
  /// capacity  items, rounded up to a power of two; all memory is taken and touched here.
  explicit SpscRing(std::size_t capacity)
      : mask_{std::bit_ceil(std::max<std::size_t>(capacity, 1)) - 1}, slots_{std::make_unique<T[]>(mask_ + 1)} {}

  /// The same, with prepare(slot) called for every slot, e.g. to reserve its memory.
  template <class Prepare>
  SpscRing(std::size_t capacity, Prepare&& prepare) : SpscRing{capacity} {
    for (std::size_t i = 0; i <= mask_; ++i) prepare(slots_[i]);
  }

  /// Producer only. Copies the item in; false (and counted) when the ring is full. Wait-free.
  bool try_push(const T& item) SLAMD_NONBLOCKING {
    T* slot = claim();
    if (slot == nullptr) return false;
    *slot = item;
    commit();
    return true;
  }

  /// Producer only. The next free slot to be written in place (it holds an old item), or nullptr, counted as a drop,
  /// when the ring is full. The consumer sees the slot after commit(); without commit() nothing happens.
  T* claim() SLAMD_NONBLOCKING {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - cached_tail_ > mask_) {
      cached_tail_ = tail_.load(std::memory_order_acquire);  // pairs with pop(): the slot's reader is done
      if (head - cached_tail_ > mask_) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return nullptr;
      }
    }
    return &slots_[head & mask_];
  }

  /// Producer only, once after each successful claim().
  void commit() SLAMD_NONBLOCKING {
    const std::uint64_t head = head_.load(std::memory_order_relaxed) + 1;
    head_.store(head, std::memory_order_release);  // pairs with front(): the slot's content is written
    const std::uint64_t high_water = high_water_.load(std::memory_order_relaxed);
    if (head - cached_tail_ <= high_water) return;
    cached_tail_ = tail_.load(std::memory_order_acquire);
    if (head - cached_tail_ > high_water) high_water_.store(head - cached_tail_, std::memory_order_relaxed);
  }

  /// Consumer only. The oldest item, to be read in place, or nullptr when there is none. Valid until pop().
  T* front() SLAMD_NONBLOCKING {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == cached_head_) {
      cached_head_ = head_.load(std::memory_order_acquire);  // pairs with commit()
      if (tail == cached_head_) return nullptr;
    }
    return &slots_[tail & mask_];
  }

  /// Consumer only, after front() gave an item.
  void pop() SLAMD_NONBLOCKING {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    assert(tail != cached_head_);
    tail_.store(tail + 1, std::memory_order_release);  // pairs with claim()
  }

  std::size_t capacity() const { return mask_ + 1; }

  /// Any thread. Each number is exact; together they are of slightly different instants while the sides run.
  RingCounts counts() const {
    const std::uint64_t tail = tail_.load(std::memory_order_acquire);
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    return {.capacity = capacity(),
            .size = static_cast<std::size_t>(std::min<std::uint64_t>(head - tail, capacity())),
            .high_water = static_cast<std::size_t>(high_water_.load(std::memory_order_relaxed)),
            .pushed = head,
            .dropped = dropped_.load(std::memory_order_relaxed)};
  }

 private:
  static constexpr std::size_t kCacheLine = 64;

  const std::size_t mask_;
  const std::unique_ptr<T[]> slots_;
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};  // items ever committed; written by the producer
  std::uint64_t cached_tail_ = 0;                           // the producer's last sight of tail_
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> high_water_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};  // items ever popped; written by the consumer
  std::uint64_t cached_head_ = 0;                           // the consumer's last sight of head_
};

}  // namespace slamd
