#include "drivers/robosense/airy_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/robosense/airy_timing.hpp"

namespace slamd {
namespace {

constexpr double kMetresPerCount = 0.005;
constexpr double kRadPerCdeg = std::numbers::pi / 18000.0;

/// Azimuths may lie a turn off: those of channels that look beyond the seam.
std::uint16_t wrapped(std::int32_t azimuth_cdeg) {
  const std::int32_t left = azimuth_cdeg % kFullCircleCdeg;
  return static_cast<std::uint16_t>(left < 0 ? left + kFullCircleCdeg : left);
}

}  // namespace

AiryDecoder::AiryDecoder(const LidarDecoderConfig& config)
    : config_{config}, timeline_{config.stamp_tolerance}, clock_{config.clock} {}

const LidarPacket* AiryDecoder::decode(std::span<const std::uint8_t> payload, HostTime arrival) {
  ++stats_.received;
  const auto [parse_cause, packet] = parse_airy(payload);
  if (parse_cause != LidarRejection::kCount) return refuse(parse_cause);
  if (!device_) return refuse(LidarRejection::kNoAngles);
  const auto columns = std::span{packet.azimuth_cdeg}.first(airy_columns(packet.returns));
  const auto [turn_fault, rotation] = find_rotation(columns, kAiryColumn, config_.rotation);
  if (turn_fault != RotationFault::kNone) return refuse(rejection_of(turn_fault));
  const Duration span = airy_packet_span(packet.returns);
  const float rate = rotation.mean_step_cdeg / static_cast<float>(kAiryColumn.count());
  const PacketAdmission admission =
      timeline_.admit({packet.stamp, arrival, static_cast<float>(columns.front()), rate}, span);
  if (admission.verdict != PacketVerdict::kAdmitted) return refuse(rejection_of(admission.verdict));

  ++stats_.accepted;
  stats_.lost += admission.lost_packets;
  stats_.clock_jumps += admission.jumped ? 1 : 0;
  out_.time = clock_.update(packet.stamp + span, arrival) - span;  // a packet is sent after its last firing
  out_.arrival = arrival;
  out_.span = span;
  out_.clock_unsure = clock_.is_recovering();
  fill_points(packet, rotation);
  return &out_;
}

const LidarPacket* AiryDecoder::refuse(LidarRejection cause) {
  stats_.rejections.add(cause);
  last_rejection_ = cause;
  return nullptr;
}

bool AiryDecoder::inform(std::span<const std::uint8_t> payload) {
  const Result<AiryDevice> device = parse_airy_device(payload);
  if (!device) return false;
  set_beams(*device);
  device_ = *device;
  return true;
}

/// Rings count from the lowest beam up.
void AiryDecoder::set_beams(const AiryDevice& device) {
  const auto& elevations = device.elevation_cdeg;
  for (std::size_t i = 0; i < kAiryChannels; ++i) {
    const auto is_below = [&](std::size_t k) { return std::pair{elevations[k], k} < std::pair{elevations[i], i}; };
    std::uint8_t ring = 0;
    for (std::size_t k = 0; k < kAiryChannels; ++k) ring = static_cast<std::uint8_t>(ring + (is_below(k) ? 1 : 0));
    const double elevation = elevations[i] * kRadPerCdeg;
    const double offset = device.azimuth_offset_cdeg[i] * kRadPerCdeg;
    beams_[i] = {static_cast<float>(std::cos(elevation)),
                 static_cast<float>(std::sin(elevation)),
                 static_cast<float>(std::cos(offset)),
                 static_cast<float>(std::sin(offset)),
                 device.azimuth_offset_cdeg[i],
                 ring};
  }
}

/// The column's azimuth is turned on by the small angle to each group with sin and cos to third order: 1e-8 rad off at 1200 rpm.
AiryDecoder::Aims AiryDecoder::aim(float azimuth_cdeg, float step_cdeg, Duration column_begin) {
  const auto s = static_cast<float>(std::sin(azimuth_cdeg * kRadPerCdeg));
  const auto c = static_cast<float>(std::cos(azimuth_cdeg * kRadPerCdeg));
  Aims aims;
  for (std::size_t group = 0; group < aims.size(); ++group) {
    const Duration delay = kAiryGroupDelay[group];
    const float turned_cdeg = step_cdeg * static_cast<float>(delay.count()) / static_cast<float>(kAiryColumn.count());
    const float d = turned_cdeg * static_cast<float>(kRadPerCdeg);
    const float sin_d = d - d * d * d / 6.0F;
    const float cos_d = 1.0F - d * d / 2.0F;
    aims[group] = {c * cos_d - s * sin_d, s * cos_d + c * sin_d,
                   static_cast<std::int32_t>(azimuth_cdeg + turned_cdeg + 0.5F),
                   static_cast<std::int32_t>((column_begin + delay).count())};
  }
  return aims;
}

void AiryDecoder::fill_points(const AiryPacket& packet, const HeadRotation& rotation) {
  out_.point_count = 0;
  for (std::size_t column = 0; column < rotation.columns; ++column) {
    const Aims aims = aim(rotation.azimuth_cdeg[column], rotation.step_cdeg[column], static_cast<int>(column) * kAiryColumn);
    if (column == 0) out_.azimuth_begin_cdeg = wrapped(aims.front().azimuth_cdeg);
    out_.azimuth_end_cdeg = wrapped(aims.back().azimuth_cdeg);
    for (std::size_t channel = 0; channel < kAiryChannels; ++channel) {
      add_firing(packet, column, channel, aims[channel / kAiryGroup]);
    }
  }
  stats_.points += out_.point_count;
}

void AiryDecoder::add_firing(const AiryPacket& packet, std::size_t column, std::size_t channel, const Aim& aim) {
  const Beam& beam = beams_[channel];
  AiryReturn strongest = packet.at(column, channel);
  if (packet.returns == AiryReturns::kSingle) {
    if (in_range(strongest)) add_point(beam, aim, strongest, 0);
    return;
  }
  AiryReturn other = packet.at(column, channel, 1);
  const bool same = strongest.distance_5mm == other.distance_5mm;
  if (other.intensity > strongest.intensity) std::swap(strongest, other);
  std::uint8_t index = 0;
  if (in_range(strongest)) add_point(beam, aim, strongest, index++);
  if (!same && in_range(other)) add_point(beam, aim, other, index);
}

bool AiryDecoder::in_range(AiryReturn found) {
  if (found.distance_5mm == 0) return false;
  const double range_m = found.distance_5mm * kMetresPerCount;
  const bool inside = range_m >= config_.min_range_m && range_m <= config_.max_range_m;
  stats_.out_of_range += inside ? 0 : 1;
  return inside;
}

void AiryDecoder::add_point(const Beam& beam, const Aim& aim, AiryReturn found, std::uint8_t index) {
  const float range_m = static_cast<float>(found.distance_5mm) * static_cast<float>(kMetresPerCount);
  const float level_m = range_m * beam.cos_elevation;
  const float cos_azimuth = aim.cos_azimuth * beam.cos_offset - aim.sin_azimuth * beam.sin_offset;
  const float sin_azimuth = aim.sin_azimuth * beam.cos_offset + aim.cos_azimuth * beam.sin_offset;
  out_.points[out_.point_count++] = {level_m * cos_azimuth + kAiryCentreRadius_m * aim.cos_azimuth,
                                     -level_m * sin_azimuth - kAiryCentreRadius_m * aim.sin_azimuth,
                                     range_m * beam.sin_elevation + kAiryCentreHeight_m,
                                     aim.time_ns,
                                     wrapped(aim.azimuth_cdeg + beam.offset_cdeg),
                                     beam.ring,
                                     found.intensity,
                                     index};
}

}  // namespace slamd
