#pragma once
// Eight floats side by side, as the compiler's vector type: AVX2 on x86-64-v3, plain instructions elsewhere. Only what
// the map's searches need; no general vector library.

#include <cstdint>
#include <cstring>

#ifdef __AVX__
#include <immintrin.h>
#endif

// Without AVX the vectors travel by memory; only inside the files that include this, whose calls all agree on it.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace slamd {

using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

inline Float8 load8(const float* from) {
  Float8 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

inline void store8(Float8 value, float* to) {
  std::memcpy(to, &value, sizeof value);
}

inline Float8 splat8(float value) {
  return Float8{} + value;
}

inline Int8 splat8(std::int32_t value) {
  return Int8{} + value;
}

inline Float8 max8(Float8 a, Float8 b) {
#ifdef __AVX__
  return _mm256_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}

inline Float8 min8(Float8 a, Float8 b) {
#ifdef __AVX__
  return _mm256_min_ps(a, b);
#else
  return a < b ? a : b;
#endif
}

/// Bit i of the result is lane i of a comparison.
inline std::uint32_t bits8(Int8 mask) {
#ifdef __AVX__
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(mask))));
#else
  std::uint32_t bits = 0;
  for (int lane = 0; lane < 8; ++lane) bits |= (static_cast<std::uint32_t>(mask[lane]) & 1U) << lane;
  return bits;
#endif
}

/// x*x + y*y + z*z in each lane. Boxes and points use this one function: rounding is monotone, so that the distance of
/// a box is never above that of a point inside it.
inline Float8 squared_norm8(Float8 x, Float8 y, Float8 z) {
  return x * x + y * y + z * z;
}

}  // namespace slamd
