#include "drivers/rplidar/rplidar_unpacker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr float kRadPerDeg = std::numbers::pi_v<float> / 180.0F;
constexpr std::size_t kCabinsFrom = 4;  // of a capsule: two bytes of checksum, two of angle before
constexpr std::size_t kExpressCabins = 16;
constexpr std::size_t kBoostCabins = 32;
constexpr float kLeastTurn_deg = 5.0F;  // in one capsule: 5 to 15 revolutions a second are 14 to 65 degrees, with a margin
constexpr float kMostTurn_deg = 72.0F;
constexpr float kEvenTurn = 0.25F;     // a capsule turns like the one before it, less or more by this share
constexpr float kBaseline_mm = 24.01F;  // between emitter and lens
constexpr float kMostOffset_deg = 8.0F;
constexpr float kNearOffset_deg = 7.5F;
constexpr float kNear_mm = 50.0F;

float begin_of(std::span<const std::uint8_t> capsule) {
  ByteReader reader{capsule.subspan(2, 2)};
  return static_cast<float>(reader.u16_le() & 0x7FFFU) / 64.0F;
}

/// The two ranges of a boost cabin that are told by their difference to a neighbour; nothing for the values that mean none.
std::optional<std::int32_t> difference(std::uint32_t cabin, unsigned from_bit) {
  const auto bits = static_cast<std::int32_t>((cabin >> from_bit) & 0x3FFU);
  const std::int32_t value = bits >= 512 ? bits - 1024 : bits;
  return value == -512 || value == 511 ? std::nullopt : std::optional{value};
}

std::uint32_t cabin_of(std::span<const std::uint8_t> capsule, std::size_t cabin) {
  return ByteReader{capsule.subspan(kCabinsFrom + 4 * cabin, 4)}.u32_le();
}

float near(const std::optional<std::int32_t>& steps, const RplidarScaled& base) {
  if (!steps) return 0.0F;
  return std::max(0.0F, static_cast<float>(base.range_mm) + static_cast<float>(*steps) * static_cast<float>(1U << base.level));
}

}  // namespace

float rplidar_offset_deg(float range_mm) {
  if (range_mm < kNear_mm) return kNearOffset_deg;
  return kMostOffset_deg - std::asin(kBaseline_mm / range_mm) / kRadPerDeg;
}

RplidarScaled rplidar_unscale(std::uint32_t scaled) {
  struct Level {
    std::uint32_t scaled_from, range_from_mm;
  };
  constexpr std::array<Level, 5> kLevels{{{0, 0}, {512, 512}, {1280, 2048}, {1792, 4096}, {3328, 16384}}};
  std::uint32_t level = 4;
  while (level > 0 && scaled < kLevels[level].scaled_from) --level;
  return {kLevels[level].range_from_mm + ((scaled - kLevels[level].scaled_from) << level), level};
}

void RplidarUnpacker::restart() {
  count_ = 0;
  last_size_ = 0;
  turn_deg_ = 0.0F;
  last_raw_deg_ = 0.0F;
}

std::optional<RplidarSamples> RplidarUnpacker::take(const RplidarPacket& packet) {
  if (packet.answer == RplidarAnswer::kScan) return take_node(packet.bytes);
  return take_capsule(packet);
}

std::optional<RplidarSamples> RplidarUnpacker::take_node(std::span<const std::uint8_t> bytes) {
  ByteReader reader{bytes};
  const std::uint8_t flags = reader.u8();
  const float angle_deg = std::fmod(static_cast<float>(reader.u16_le() >> 1U) / 64.0F, 360.0F);
  const float range_mm = static_cast<float>(reader.u16_le()) / 4.0F;
  samples_[count_++] = {angle_deg * kRadPerDeg, range_mm * 1e-3F, static_cast<std::uint8_t>(flags >> 2U), (flags & 1U) != 0};
  if (count_ < kRplidarNodesTogether) return std::nullopt;
  count_ = 0;
  return RplidarSamples{std::span{samples_}.first(kRplidarNodesTogether), false};
}

/// Whether the capsule is the very next one. A turn that is too large may hide a missing capsule, one that is too small hides nothing: the
/// expectation was wrong.
bool RplidarUnpacker::follows(float turned_deg) {
  if (turned_deg < kLeastTurn_deg || turned_deg > kMostTurn_deg) return false;
  const bool even = turn_deg_ == 0.0F || std::abs(turned_deg - turn_deg_) <= kEvenTurn * turn_deg_;
  if (even || turned_deg < turn_deg_) turn_deg_ = turned_deg;
  return even;
}

std::optional<RplidarSamples> RplidarUnpacker::take_capsule(const RplidarPacket& packet) {
  const bool has_last = last_size_ == packet.bytes.size();
  const float begin_deg = has_last ? begin_of(last_) : 0.0F;
  const float turned_deg = std::fmod(begin_of(packet.bytes) - begin_deg + 360.0F, 360.0F);
  const bool is_next = has_last && follows(turned_deg);
  const bool is_boost = packet.answer == RplidarAnswer::kBoost;
  const std::size_t count = is_boost ? 3 * kBoostCabins : 2 * kExpressCabins;
  gaps_ += has_last && !is_next ? 1 : 0;
  if (is_next) {
    const float step_deg = turned_deg / static_cast<float>(count);
    is_boost ? unpack_boost(begin_deg, step_deg, packet.bytes) : unpack_express(begin_deg, step_deg);
  }
  std::copy(packet.bytes.begin(), packet.bytes.end(), last_.begin());
  last_size_ = packet.bytes.size();
  if (!is_next) return std::nullopt;
  return RplidarSamples{std::span{samples_}.first(count), true};
}

void RplidarUnpacker::put(std::size_t at, float raw_deg, float offset_deg, float range_mm) {
  const float turned_deg = std::fmod(raw_deg, 360.0F);
  const float angle_deg = std::fmod(turned_deg - offset_deg + 360.0F, 360.0F);
  samples_[at] = {std::min(angle_deg * kRadPerDeg, std::nextafter(2.0F * std::numbers::pi_v<float>, 0.0F)), range_mm * 1e-3F,
                  static_cast<std::uint8_t>(range_mm > 0.0F ? 47 : 0), turned_deg < last_raw_deg_};
  last_raw_deg_ = turned_deg;
}

/// Two ranges of 14 bits (millimetres) and two offsets of 6 (eighths of a degree) in each cabin of five bytes.
void RplidarUnpacker::unpack_express(float begin_deg, float step_deg) {
  for (std::size_t cabin = 0; cabin < kExpressCabins; ++cabin) {
    ByteReader reader{std::span{last_}.subspan(kCabinsFrom + 5 * cabin, 5)};
    const std::array<unsigned, 2> words{reader.u16_le(), reader.u16_le()};
    const unsigned low = reader.u8();
    for (std::size_t half = 0; half < 2; ++half) {
      const unsigned offset_8th = ((low >> (4 * half)) & 0xFU) | ((words[half] & 3U) << 4U);
      const std::size_t at = 2 * cabin + half;
      put(at, begin_deg + step_deg * static_cast<float>(at), static_cast<float>(offset_8th) / 8.0F,
          static_cast<float>(words[half] >> 2U));
    }
  }
}

/// In each cabin one range of 12 scaled bits and two differences of 10: to this cabin's range (the next one's where this is none) and to
/// the next one's.
void RplidarUnpacker::unpack_boost(float begin_deg, float step_deg, std::span<const std::uint8_t> next) {
  for (std::size_t cabin = 0; cabin < kBoostCabins; ++cabin) {
    const std::uint32_t word = cabin_of(last_, cabin);
    const std::uint32_t after = cabin + 1 < kBoostCabins ? cabin_of(last_, cabin + 1) : cabin_of(next, 0);
    const RplidarScaled major = rplidar_unscale(word & 0xFFFU);
    const RplidarScaled following = rplidar_unscale(after & 0xFFFU);
    const RplidarScaled& base = major.range_mm == 0 && following.range_mm != 0 ? following : major;
    const std::array<float, 3> ranges_mm{static_cast<float>(major.range_mm), near(difference(word, 12), base),
                                         near(difference(word, 22), following)};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = 3 * cabin + i;
      put(at, begin_deg + step_deg * static_cast<float>(at), rplidar_offset_deg(ranges_mm[i]), ranges_mm[i]);
    }
  }
}

}  // namespace slamd
