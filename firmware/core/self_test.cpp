#include "firmware/core/self_test.hpp"

namespace slamd {
namespace {

// Data sheet, table 3: change of output, accelerometer in mg, gyroscope in tenths of dps.
constexpr std::int32_t kAccelMin = 50, kAccelMax = 1700, kGyroMin = 1500, kGyroMax = 7000;

/// Counts to mg at +-4 g: 0.122 a count.
constexpr std::int32_t to_mg(std::int32_t counts) {
  return counts * 122 / 1000;
}
/// Counts to tenths of dps at +-2000 dps: 0.7 a count. A change from end to end does not fit into 16 bits.
constexpr std::int32_t to_ddps(std::int32_t counts) {
  constexpr std::int32_t kMost = 32767;
  const std::int32_t change = counts * 7 / 10;
  return change > kMost ? kMost : change < -kMost ? -kMost : change;
}

constexpr bool within(std::int32_t change, std::int32_t least, std::int32_t most) {
  const std::int32_t size = change < 0 ? -change : change;
  return size >= least && size <= most;
}

}  // namespace

SelfTest::Progress SelfTest::add(const RawSample& sample) {
  auto& sums = sums_[samples_ < kSamples ? 0 : 1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sums[axis] += sample.accel[axis];
    sums[3 + axis] += sample.gyro[axis];
  }
  ++samples_;
  return samples_ == kSamples ? Progress::kHalf : samples_ == 2 * kSamples ? Progress::kComplete : Progress::kMore;
}

SelfTestReport SelfTest::report() const {
  SelfTestReport report;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t accel = to_mg((sums_[1][axis] - sums_[0][axis]) / kSamples);
    const std::int32_t gyro = to_ddps((sums_[1][3 + axis] - sums_[0][3 + axis]) / kSamples);
    report.accel_mg[axis] = static_cast<std::int16_t>(accel);
    report.gyro_ddps[axis] = static_cast<std::int16_t>(gyro);
    const unsigned accel_failed = within(accel, kAccelMin, kAccelMax) ? 0U : 1U << axis;
    const unsigned gyro_failed = within(gyro, kGyroMin, kGyroMax) ? 0U : 8U << axis;
    report.failed_axes = static_cast<std::uint8_t>(report.failed_axes | accel_failed | gyro_failed);
  }
  report.outcome = report.failed_axes == 0 ? SelfTestOutcome::kPassed : SelfTestOutcome::kFailed;
  return report;
}

}  // namespace slamd
