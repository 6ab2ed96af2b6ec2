#include "tools/slam-sim/sensors/rplidar_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::sim {
namespace {

constexpr Optics kOptics{.nearest_m = 0.15, .farthest_m = 18.0, .reach_m = 9.0, .full_m = 14.0, .noise_share = 0.005};
constexpr double kNearNoise = 0.25;      // of --range-noise: what is left close to the sensor, where triangulation is exact
constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kBaseline_m = 0.02401;  // from emitter to lens
constexpr double kBaud = 115'200.0;
constexpr double kLatencyMin = 0.0005, kLatencyJitter = 0.001;

double offset_deg(double range_m) {
  return range_m < 0.05 ? 7.5 : 8.0 - std::asin(kBaseline_m / range_m) / kDeg;
}

double wrapped(double deg) {
  const double left = std::fmod(deg, 360.0);
  return left < 0.0 ? left + 360.0 : left;
}

/// Checksum and start angle; the flag of a stream's first capsule.
void finish_capsule(std::vector<std::uint8_t>& bytes, double begin_deg) {
  const auto angle = static_cast<unsigned>(std::lround(wrapped(begin_deg) * 64.0)) % (360U * 64U);
  bytes[2] = static_cast<std::uint8_t>(angle);
  bytes[3] = static_cast<std::uint8_t>(angle >> 8U);
  std::uint8_t sum = 0;
  for (std::size_t i = 2; i < bytes.size(); ++i) sum ^= bytes[i];
  bytes[0] = static_cast<std::uint8_t>(0xA0U | (sum & 0xFU));
  bytes[1] = static_cast<std::uint8_t>(0x50U | (sum >> 4U));
}

/// 12 bits, coarser with distance, and what they say exactly.
struct Scaled {
  unsigned bits;
  int range_mm;
  int step_mm;
};
Scaled scale(double range_m) {
  struct Level {
    int bits_from, range_from_mm;
  };
  constexpr std::array<Level, 5> kLevels{{{0, 0}, {512, 512}, {1280, 2048}, {1792, 4096}, {3328, 16384}}};
  const int mm = static_cast<int>(std::lround(range_m * 1e3));
  std::size_t level = 4;
  while (level > 0 && mm < kLevels[level].range_from_mm) --level;
  const int step = 1 << level;
  const int bits = std::min(kLevels[level].bits_from + (mm - kLevels[level].range_from_mm) / step, 4095);
  return {static_cast<unsigned>(bits), kLevels[level].range_from_mm + (bits - kLevels[level].bits_from) * step, step};
}

/// Ten bits; 511 where there is no echo or it is too far from its neighbour.
unsigned difference(double range_m, const Scaled& base) {
  if (range_m <= 0.0) return 511;
  const auto steps = std::lround((range_m * 1e3 - base.range_mm) / base.step_mm);
  return steps < -511 || steps > 510 ? 511U : static_cast<unsigned>(steps) & 0x3FFU;
}

}  // namespace

RplidarFormat format_of(RplidarFirmware firmware) {
  switch (firmware) {
    case RplidarFirmware::kStandard: return {32 * 5, 32, 500};
    case RplidarFirmware::kExpress: return {84, 32, 250};
    case RplidarFirmware::kBoost: break;
  }
  return {132, 96, 125};
}

RplidarSensor::RplidarSensor(const LidarModel& model, RplidarFirmware firmware, const Surroundings& around, SensorClock clock,
                             std::uint64_t seed)
    : model_{model},
      firmware_{firmware},
      format_{format_of(firmware)},
      caster_{[&] {
                BeamModel beam = model;
                beam.range_noise_m *= kNearNoise;
                return beam;
              }(),
              kOptics, around},
      clock_{std::move(clock)},
      seed_{seed} {}

double RplidarSensor::packet_time(std::int64_t index) const {
  return static_cast<double>(index * format_.samples) * format_.period_us * 1e-6 / clock_.rate();
}

/// The echo's direction depends on its range, and the range on the direction: two rounds settle both.
RplidarSensor::Sample RplidarSensor::sample(std::int64_t number, const Movers& movers) const {
  const double t = static_cast<double>(number) * format_.period_us * 1e-6 / clock_.rate();
  const double raw_deg = wrapped(model_.rpm * 6.0 * clock_.rate() * t);
  Sample found{raw_deg, wrapped(raw_deg - offset_deg(4.0)), 0.0};
  for (int round = 0; round < 3; ++round) {
    Rng rng{seed_, Stream::kLidar, static_cast<std::uint64_t>(number)};
    const Echoes echoes = caster_.fire({t, found.angle_deg * kDeg, 0.0, Eigen::Vector3d::Zero()}, movers, rng);
    found.range_m = echoes.strongest.range_m <= kOptics.farthest_m ? echoes.strongest.range_m : 0.0;
    const double before_deg = found.angle_deg;
    found.angle_deg = wrapped(raw_deg - offset_deg(found.range_m));
    if (std::abs(found.angle_deg - before_deg) < 0.02) break;
  }
  return found;
}

std::vector<std::uint8_t> RplidarSensor::nodes(const std::vector<Sample>& samples) const {
  std::vector<std::uint8_t> bytes;
  const double step_deg = model_.rpm * 6.0 * format_.period_us * 1e-6;
  for (int i = 0; i < format_.samples; ++i) {
    const Sample& s = samples[static_cast<std::size_t>(i)];
    const bool begins = wrapped(s.raw_deg + 0.5 * step_deg) < step_deg;
    const unsigned quality = s.range_m > 0.0 ? 47 : 0;
    const auto angle = static_cast<unsigned>(std::lround(s.angle_deg * 64.0)) % (360U * 64U);
    const auto range = static_cast<unsigned>(std::lround(s.range_m * 4e3));
    bytes.push_back(static_cast<std::uint8_t>((quality << 2U) | (begins ? 1U : 2U)));
    bytes.push_back(static_cast<std::uint8_t>((angle << 1U) | 1U));
    bytes.push_back(static_cast<std::uint8_t>(angle >> 7U));
    bytes.push_back(static_cast<std::uint8_t>(range));
    bytes.push_back(static_cast<std::uint8_t>(range >> 8U));
  }
  return bytes;
}

std::vector<std::uint8_t> RplidarSensor::express(const std::vector<Sample>& samples) const {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(format_.bytes));
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const auto range = std::min(static_cast<unsigned>(std::lround(samples[i].range_m * 1e3)), 0x3FFFU);
    const auto offset = static_cast<unsigned>(std::lround(offset_deg(samples[i].range_m) * 8.0)) & 0x3FU;
    const unsigned word = (range << 2U) | (offset >> 4U);
    const std::size_t cabin = 4 + i / 2 * 5;
    bytes[cabin + i % 2 * 2] = static_cast<std::uint8_t>(word);
    bytes[cabin + i % 2 * 2 + 1] = static_cast<std::uint8_t>(word >> 8U);
    bytes[cabin + 4] = static_cast<std::uint8_t>(bytes[cabin + 4] | ((offset & 0xFU) << (4U * (i % 2))));
  }
  finish_capsule(bytes, samples.front().raw_deg);
  return bytes;
}

std::vector<std::uint8_t> RplidarSensor::boost(const std::vector<Sample>& samples) const {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(format_.bytes));
  for (std::size_t i = 0; i + 3 < samples.size(); i += 3) {
    const Scaled major = scale(samples[i].range_m), following = scale(samples[i + 3].range_m);
    const Scaled& base = major.range_mm == 0 && following.range_mm != 0 ? following : major;
    const unsigned word =
        major.bits | (difference(samples[i + 1].range_m, base) << 12U) | (difference(samples[i + 2].range_m, following) << 22U);
    for (unsigned byte = 0; byte < 4; ++byte) bytes[4 + i / 3 * 4 + byte] = static_cast<std::uint8_t>(word >> (8U * byte));
  }
  finish_capsule(bytes, samples.front().raw_deg);
  return bytes;
}

WireEvent RplidarSensor::packet(std::int64_t index) const {
  const double begin = packet_time(index);
  const Movers movers = caster_.movers_at(begin);
  std::vector<Sample> samples;  // and the first one of the next packet
  for (int i = 0; i <= format_.samples; ++i) samples.push_back(sample(index * format_.samples + i, movers));
  WireEvent event{Channel::kLidar, std::llround(begin * 1e9), 0, {}};
  if (firmware_ == RplidarFirmware::kStandard) event.bytes = nodes(samples);
  if (firmware_ == RplidarFirmware::kExpress) event.bytes = express(samples);
  if (firmware_ == RplidarFirmware::kBoost) event.bytes = boost(samples);
  Rng rng{seed_, Stream::kLidarUnit, static_cast<std::uint64_t>(index) + 16};
  const double last_byte = firmware_ == RplidarFirmware::kStandard ? 5 * 10 / kBaud : 10.0 * format_.bytes / kBaud;
  const double end = begin + (format_.samples - 1) * format_.period_us * 1e-6 / clock_.rate();
  event.arrival_ns = std::llround((end + last_byte + kLatencyMin + kLatencyJitter * rng.uniform()) * 1e9);
  return event;
}

}  // namespace slamd::sim
