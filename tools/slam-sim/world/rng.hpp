#pragma once
// Seeded random numbers addressed by (seed, stream, counter), so that results do not depend on threads. Not for
// secrets.

#include <cmath>
#include <cstdint>
#include <numbers>

namespace slamd::sim {

/// One independent stream per purpose: adding a draw to one never shifts another.
enum class Stream : std::uint64_t {
  kWorld = 1,
  kMotion,
  kTraffic,
  kLidar,
  kLidarUnit,
  kPosition,
  kImu,
  kImuUnit,
  kGps,
  kFault,
  kPlanarLidar,
  kWheel,
  kWheelUnit
};

/// SplitMix64 (Steele et al. 2014) keyed by a hash of its address: a few ns a draw, cheap to construct per packet.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, Stream stream, std::uint64_t counter = 0)
      : state_{mix(mix(seed + static_cast<std::uint64_t>(stream) * kGolden) + counter * kGolden)} {}

  std::uint64_t next() { return mix(state_ += kGolden); }
  /// [0, 1)
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// 0 .. count-1
  int index(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }
  /// Standard normal by Box-Muller; both values of a pair are used.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  double exponential() { return -std::log(1.0 - uniform()); }

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;
  static constexpr std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace slamd::sim
