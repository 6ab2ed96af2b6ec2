#pragma once
// A block of words with one writer and any number of readers that never see a torn block: a sequence lock over atomic
// words, fit for memory shared between processes. Not for several writers; readers retry while a write is under way.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "daemon/ring/nonblocking.hpp"

namespace slamd {

template <std::size_t kWords>
class Seqlock {
 public:
  using Words = std::array<std::uint64_t, kWords>;
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  /// Writer only. Wait-free.
  void store(const Words& words) SLAMD_NONBLOCKING {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);  // odd: a write is under way
    // Release on each word: a reader that sees any new word also sees the odd sequence, or a later one.
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// For a writer that takes over from one that has died, perhaps inside store(): as if nothing was ever stored. Readers
  /// may be reading.
  void clear() { sequence_.store(0, std::memory_order_release); }

  /// Any thread. False when nothing was ever stored, or when no quiet moment came within `attempts` tries (a writer
  /// that died inside store() leaves the block so for ever); then `words` is unspecified.
  bool load(Words& words, int attempts = kAttempts) const {
    for (; attempts > 0; --attempts) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == 0) return false;
      if ((before & 1U) != 0) continue;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) == before) return true;
    }
    return false;
  }

  /// Any thread. False when nothing was ever stored, nor is being stored for the first time.
  bool begun() const { return sequence_.load(std::memory_order_acquire) != 0; }

  /// About a millisecond of trying: far longer than a writer that is running needs.
  static constexpr int kAttempts = 20'000;

 private:
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace slamd
