#pragma once
// A value or the reason why there is none. The reason is a static text, so a Result never allocates for its error.

#include <cassert>
#include <optional>
#include <utility>

namespace slamd {

struct Error {
  const char* reason;
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_{std::move(value)} {}
  Result(Error error) : error_{error} {}

  explicit operator bool() const { return value_.has_value(); }
  const T& value() const& { assert(value_); return *value_; }
  T&& value() && { assert(value_); return std::move(*value_); }
  const T& operator*() const& { return value(); }
  const T* operator->() const { assert(value_); return &*value_; }
  /// Static text; only where there is no value.
  const char* reason() const { assert(!value_); return error_.reason; }

 private:
  std::optional<T> value_;
  Error error_{""};
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_{error} {}
  explicit operator bool() const { return error_.reason == nullptr; }
  const char* reason() const { assert(error_.reason); return error_.reason; }

 private:
  Error error_{nullptr};
};

}  // namespace slamd
