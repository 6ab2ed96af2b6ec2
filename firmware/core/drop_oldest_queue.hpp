#pragma once
// A ring of N values; when it is full the oldest makes room and is counted by the caller. One thread.

#include <array>
#include <cstddef>

namespace slamd {

template <class T, std::size_t N>
class DropOldestQueue {
 public:
  /// False when the oldest value had to go.
  bool push(const T& value) {
    const bool full = size_ == N;
    if (full) pop();
    values_[(first_ + size_) % N] = value;
    ++size_;
    return !full;
  }

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  /// The oldest; not when empty.
  const T& front() const { return values_[first_]; }
  void pop() {
    first_ = (first_ + 1) % N;
    --size_;
  }
  void clear() { size_ = 0; }

 private:
  static_assert((N & (N - 1)) == 0);  // the core divides slowly
  std::array<T, N> values_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace slamd
