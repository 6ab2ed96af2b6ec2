#pragma once
// Measurement packets of an RPLIDAR to samples: direction, range, quality. No time and no revolutions (rplidar_parser).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/rplidar/rplidar_reader.hpp"

namespace slamd {

struct RplidarSample {
  float angle_rad;     // clockwise seen from above, 0 = the sensor's front, 0 <= angle < 2 pi
  float range_m;       // 0 = nothing came back
  std::uint8_t quality;
  bool begins_turn;    // the first one after the head passed its zero
};

constexpr std::size_t kRplidarNodesTogether = 32;  // of a standard scan: handed out so many at a time
constexpr std::size_t kRplidarMostSamples = 96;    // of one capsule

/// Samples that follow each other evenly in time.
struct RplidarSamples {
  std::span<const RplidarSample> samples;  // valid until the next call
  bool is_delayed;  // those of the packet before the one that was given: its directions end where this one's begin
};

/// One thread uses an instance; no allocation.
class RplidarUnpacker {
 public:
  /// A packet of a stream. Nothing while more packets are needed, and for a capsule whose successor is missing (counted).
  std::optional<RplidarSamples> take(const RplidarPacket& packet);
  /// A stream begins: earlier packets do not belong to it.
  void restart();

  /// Capsules given up, for the head turned by more or less than in one capsule until the next one.
  std::uint64_t gaps() const { return gaps_; }

 private:
  std::optional<RplidarSamples> take_node(std::span<const std::uint8_t> bytes);
  std::optional<RplidarSamples> take_capsule(const RplidarPacket& packet);
  bool follows(float turned_deg);
  void unpack_express(float begin_deg, float step_deg);
  void unpack_boost(float begin_deg, float step_deg, std::span<const std::uint8_t> next);
  void put(std::size_t at, float raw_deg, float offset_deg, float range_mm);

  std::array<RplidarSample, kRplidarMostSamples> samples_{};
  std::size_t count_ = 0;                               // of nodes that wait
  std::array<std::uint8_t, kRplidarBoostBytes> last_{};  // capsule
  std::size_t last_size_ = 0;                           // 0: none
  float turn_deg_ = 0.0F;      // of a capsule, as expected; 0: not known
  float last_raw_deg_ = 0.0F;  // where the head stood at the newest sample
  std::uint64_t gaps_ = 0;
};

/// What a laser beam is turned by from the head's own zero, degrees: emitter and lens are apart, so that it depends on range.
float rplidar_offset_deg(float range_mm);

/// Ranges as a boost capsule packs them: 12 bits, coarser with distance. level: range_mm is a multiple of 2^level from the level's
/// begin on.
struct RplidarScaled {
  std::uint32_t range_mm;
  std::uint32_t level;
};
RplidarScaled rplidar_unscale(std::uint32_t scaled);

}  // namespace slamd
