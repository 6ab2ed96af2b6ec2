#pragma once
// Measures and judges the sensor's built-in self-test from its samples. It does not set registers (Sensor does).

#include <array>
#include <cstdint>

#include "firmware/core/raw_sample.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd {

class SelfTest {
 public:
  static constexpr int kSamples = 16;

  enum class Progress : std::uint8_t { kMore, kHalf, kComplete };

  /// Adds a sample: the first half is the reference, the second is taken under force.
  Progress add(const RawSample& sample);

  /// After both halves. Scales: +-4 g, +-2000 dps.
  SelfTestReport report() const;

 private:
  std::array<std::array<std::int32_t, 6>, 2> sums_{};  // accel x y z, gyro x y z
  int samples_ = 0;
};

}  // namespace slamd
