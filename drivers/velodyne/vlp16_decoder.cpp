#include "drivers/velodyne/vlp16_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd {
namespace {

constexpr Duration kHour = std::chrono::hours{1};
constexpr double kMetresPerCount = 0.002;
constexpr double kRadPerCdeg = std::numbers::pi / 18000.0;

struct Laser {
  float cos_elevation;
  float sin_elevation;
  float height_m;  // vertical offset of the beam's origin
  std::uint8_t ring;
};

/// In order of firing. Source: VLP-16 User Manual, table 9-1 (elevation and vertical correction).
std::array<Laser, kVlp16Lasers> make_lasers() {
  constexpr std::array<double, kVlp16Lasers> kElevationDeg = {-15, 1, -13, 3,  -11, 5,  -9, 7,
                                                              -7,  9, -5,  11, -3,  13, -1, 15};
  constexpr std::array<double, kVlp16Lasers> kHeightMm = {11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                                          5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
  std::array<Laser, kVlp16Lasers> lasers{};
  for (std::size_t i = 0; i < kVlp16Lasers; ++i) {
    const double elevation = kElevationDeg[i] * std::numbers::pi / 180.0;
    lasers[i] = {static_cast<float>(std::cos(elevation)), static_cast<float>(std::sin(elevation)),
                 static_cast<float>(kHeightMm[i] * 1e-3), static_cast<std::uint8_t>((kElevationDeg[i] + 15.0) / 2.0)};
  }
  return lasers;
}
const std::array<Laser, kVlp16Lasers> kLasers = make_lasers();

std::uint16_t counts_of(double range_m) {
  return static_cast<std::uint16_t>(std::clamp(std::round(range_m / kMetresPerCount), 0.0, 65535.0));
}

/// Share of a block's time that has passed when a channel fires.
constexpr std::array<float, kVlp16Channels> make_shares() {
  std::array<float, kVlp16Channels> shares{};
  for (std::size_t i = 0; i < kVlp16Channels; ++i) {
    shares[i] = static_cast<float>(channel_offset(i).count()) / static_cast<float>(kVlp16Block.count());
  }
  return shares;
}
constexpr std::array<float, kVlp16Channels> kShares = make_shares();

}  // namespace

Vlp16Decoder::Vlp16Decoder(const LidarDecoderConfig& config)
    : min_range_2mm_{std::max<std::uint16_t>(counts_of(config.min_range_m), 1)},
      max_range_2mm_{counts_of(config.max_range_m)},
      share_of_offset_{config.vertical_offsets ? 1.0F : 0.0F},
      rotation_limits_{config.rotation},
      timeline_{config.stamp_tolerance},
      clock_{config.clock} {}

/// Blocks that differ in time: the two of a dual-return pair are one column.
RotationFound Vlp16Decoder::rotation_of(const Vlp16Packet& packet) const {
  std::array<std::uint16_t, kVlp16Blocks> azimuths;
  const std::size_t columns = blocks_in_time(packet.mode);
  for (std::size_t i = 0; i < columns; ++i) azimuths[i] = packet.azimuth_cdeg[i * (kVlp16Blocks / columns)];
  return find_rotation(std::span{azimuths}.first(columns), kVlp16Block, rotation_limits_);
}

/// The time congruent to the stamp that is nearest to the expected one: the stamp counts within an hour.
DeviceTime Vlp16Decoder::unwrapped(std::uint32_t stamp_us, HostTime arrival) const {
  const Duration past_hour = std::chrono::microseconds{stamp_us};
  const DeviceTime expected = timeline_.expected(arrival).value_or(DeviceTime{past_hour});
  Duration ahead = (past_hour - expected.time_since_epoch()) % kHour;
  if (ahead > kHour / 2) ahead -= kHour;
  if (ahead < -kHour / 2) ahead += kHour;
  return expected + ahead;
}

const LidarPacket* Vlp16Decoder::decode(std::span<const std::uint8_t> payload, HostTime arrival) {
  ++stats_.received;
  const auto [parse_cause, packet] = parse_vlp16(payload);
  if (parse_cause != LidarRejection::kCount) return refuse(parse_cause);
  const auto [turn_fault, rotation] = rotation_of(packet);
  if (turn_fault != RotationFault::kNone) return refuse(rejection_of(turn_fault));
  const Duration span = packet_span(packet.mode);
  const float rate = rotation.mean_step_cdeg / static_cast<float>(kVlp16Block.count());
  const DeviceTime begin = unwrapped(packet.stamp_us, arrival);
  const PacketAdmission admission =
      timeline_.admit({begin, arrival, static_cast<float>(rotation.azimuth_cdeg[0]), rate}, span);
  if (admission.verdict != PacketVerdict::kAdmitted) return refuse(rejection_of(admission.verdict));

  ++stats_.accepted;
  stats_.lost += admission.lost_packets;
  stats_.clock_jumps += admission.jumped ? 1 : 0;
  rotation_rpm_ = rotation.rpm;
  out_.time = clock_.update(begin + span, arrival) - span;  // a packet is sent after its last firing
  out_.arrival = arrival;
  out_.span = span;
  out_.clock_unsure = clock_.is_recovering();
  fill_points(packet, rotation);
  return &out_;
}

const LidarPacket* Vlp16Decoder::refuse(LidarRejection cause) {
  stats_.rejections.add(cause);
  last_rejection_ = cause;
  return nullptr;
}

/// The block's azimuth is turned on by each channel's small angle with sin and cos to third order: 1e-9 rad off at 1200
/// rpm.
Vlp16Decoder::Beams Vlp16Decoder::aim(float azimuth_cdeg, float step_cdeg) {
  const auto s = static_cast<float>(std::sin(azimuth_cdeg * kRadPerCdeg));
  const auto c = static_cast<float>(std::cos(azimuth_cdeg * kRadPerCdeg));
  const float step_rad = step_cdeg * static_cast<float>(kRadPerCdeg);
  Beams beams;
  for (std::size_t i = 0; i < kVlp16Channels; ++i) {
    const float d = step_rad * kShares[i];
    const float sin_d = d - d * d * d / 6.0F;
    const float cos_d = 1.0F - d * d / 2.0F;
    beams.cos_azimuth[i] = c * cos_d - s * sin_d;
    beams.sin_azimuth[i] = s * cos_d + c * sin_d;
    const int rounded = static_cast<int>(azimuth_cdeg + step_cdeg * kShares[i] + 0.5F);
    beams.azimuth_cdeg[i] =
        static_cast<std::uint16_t>(rounded >= kFullCircleCdeg ? rounded - kFullCircleCdeg : rounded);
  }
  return beams;
}

void Vlp16Decoder::fill_points(const Vlp16Packet& packet, const HeadRotation& rotation) {
  out_.point_count = 0;
  const bool dual = packet.mode == Vlp16ReturnMode::kDual;
  for (std::size_t block = 0; block < rotation.columns; ++block) {
    const Beams beams = aim(rotation.azimuth_cdeg[block], rotation.step_cdeg[block]);
    if (block == 0) out_.azimuth_begin_cdeg = beams.azimuth_cdeg.front();
    out_.azimuth_end_cdeg = beams.azimuth_cdeg.back();
    const Duration block_time = static_cast<int>(block) * kVlp16Block;
    for (std::size_t channel = 0; channel < kVlp16Channels; ++channel) {
      const auto time_ns = static_cast<std::int32_t>((block_time + channel_offset(channel)).count());
      if (dual) {
        add_pair(beams, channel, time_ns, packet.at(2 * block, channel), packet.at(2 * block + 1, channel));
      } else {
        add_single(beams, channel, time_ns, packet.at(block, channel));
      }
    }
  }
  stats_.points += out_.point_count;
}

void Vlp16Decoder::add_single(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found) {
  if (in_range(found)) add_point(beams, channel, time_ns, found, 0);
}

void Vlp16Decoder::add_pair(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return even,
                            Vlp16Return odd) {
  const bool same = even.distance_2mm == odd.distance_2mm;
  Vlp16Return strongest = odd;
  Vlp16Return other = even;
  if (even.intensity > odd.intensity) std::swap(strongest, other);
  std::uint8_t index = 0;
  if (in_range(strongest)) add_point(beams, channel, time_ns, strongest, index++);
  if (!same && in_range(other)) add_point(beams, channel, time_ns, other, index);
}

bool Vlp16Decoder::in_range(Vlp16Return found) {
  if (found.distance_2mm >= min_range_2mm_ && found.distance_2mm <= max_range_2mm_) return true;
  if (found.distance_2mm != 0) ++stats_.out_of_range;
  return false;
}

void Vlp16Decoder::add_point(const Beams& beams, std::size_t channel, std::int32_t time_ns, Vlp16Return found,
                             std::uint8_t index) {
  const Laser& laser = kLasers[channel % kVlp16Lasers];
  const float range_m = static_cast<float>(found.distance_2mm) * static_cast<float>(kMetresPerCount);
  const float level_m = range_m * laser.cos_elevation;
  out_.points[out_.point_count++] = {level_m * beams.cos_azimuth[channel],
                                     -level_m * beams.sin_azimuth[channel],
                                     range_m * laser.sin_elevation + share_of_offset_ * laser.height_m,
                                     time_ns,
                                     beams.azimuth_cdeg[channel],
                                     laser.ring,
                                     found.intensity,
                                     index};
}

}  // namespace slamd
