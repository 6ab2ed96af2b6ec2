#include "daemon/threads/source_health.hpp"

#include <array>
#include <cstddef>
#include <numeric>

namespace slamd {
namespace {

using Use = SensorEvidence::Use;

constexpr Duration kLidarIsGone = std::chrono::seconds{10};  // nothing was heard for so long: it has no other way to be absent

void add_rejected(SourceHealth& health, const char* cause, std::uint64_t count) {
  if (count > 0) health.rejected.emplace_back(cause, count);
}

std::optional<HostTime> instant(bool ever, HostTime time) {
  return ever ? std::optional{time} : std::nullopt;
}

/// Whether the pose says so; one that is still being made accuses nobody.
bool says(const std::optional<PoseSample>& pose, StatusReason reason) {
  if (!pose || pose->status == static_cast<std::uint32_t>(TrackingStatus::kInitialising)) return false;
  return (pose->reasons & bit(reason)) != 0;
}

std::uint64_t sum_of(const SourceHealth& health) {
  return std::accumulate(health.rejected.begin(), health.rejected.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& entry) { return sum + entry.second; });
}

/// What the reports of both serial sensors have in common. bytes, items  so far
template <class Report>
SensorEvidence serial_evidence(const Report& report, std::uint64_t bytes, std::uint64_t items) {
  SensorEvidence told;
  told.present = report.device_open;
  told.heard = instant(bytes > 0, report.last_bytes);
  told.good_at = instant(items > 0, report.last_arrival);
  told.good = items;
  told.bad = sum_of(source_health(report));
  return told;
}

}  // namespace

SourceHealth source_health(const LidarReport& report) {
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.packets;
  health.lost = report.decoder.lost + report.socket.overflowed;
  report.decoder.rejections.for_each(
      [&](const char* cause, std::uint64_t count) { add_rejected(health, cause, count); });
  add_rejected(health, "foreign_sender", report.socket.foreign);
  add_rejected(health, "oversized", report.socket.oversized);
  health.events = {{"clock_jumps", report.decoder.clock_jumps},
                   {"position_packets", report.side.packets},
                   {"pps_locked", report.side.pps_locked}};
  if (report.packets > 0) health.clock = report.clock;
  return health;
}

SourceHealth source_health(const ImuReport& report) {
  constexpr std::array kCauses{"", "length", "cobs", "crc", "version"};
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.samples;
  health.lost = report.parser.missing;
  for (std::size_t i = 1; i < kCauses.size(); ++i) add_rejected(health, kCauses[i], report.parser.rejected[i]);
  add_rejected(health, "repeated", report.parser.repeated);
  add_rejected(health, "implausible_stamp", report.parser.implausible);
  add_rejected(health, "sensor_fault", report.parser.sensor_faults);
  health.events = {{"gaps", report.parser.gaps},
                   {"resets", report.parser.resets},
                   {"clipped", report.parser.clipped},
                   {"dropped_at_device", report.parser.dropped_at_device},
                   {"unplugged", report.source.losses}};
  if (report.parser.samples > 0) health.clock = report.clock;
  return health;
}

SourceHealth source_health(const GnssReport& report) {
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.fixes;
  add_rejected(health, "bad_checksum", report.sentences.bad_checksum);
  add_rejected(health, "no_checksum", report.sentences.no_checksum);
  add_rejected(health, "broken", report.sentences.broken);
  add_rejected(health, "too_long", report.sentences.too_long);
  add_rejected(health, "stale", report.parser.stale);
  return health;
}

SourceHealth source_health(const WheelReport& report) {
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.odometries;
  add_rejected(health, "bad_checksum", report.lines.bad_checksum);
  add_rejected(health, "no_checksum", report.lines.no_checksum);
  add_rejected(health, "broken", report.lines.broken);
  add_rejected(health, "too_long", report.lines.too_long);
  add_rejected(health, "other", report.parser.other);
  add_rejected(health, "malformed", report.parser.malformed);
  report.track.rejections.for_each([&](const char* cause, std::uint64_t count) { add_rejected(health, cause, count); });
  health.events = {{"restarts", report.track.restarts}, {"pushed", report.pushed}, {"unplugged", report.serial.losses}};
  return health;
}

SensorEvidence evidence(const LidarReport& report, const std::optional<PoseSample>& pose, HostTime now) {
  SensorEvidence told;
  told.heard = instant(report.decoder.received > 0, report.last_received);
  told.present = told.heard && now - *told.heard <= kLidarIsGone;
  told.good_at = instant(report.packets > 0, report.last_arrival);
  told.good = report.packets;
  report.decoder.rejections.for_each([&](const char*, std::uint64_t count) { told.bad += count; });
  told.lost = report.decoder.lost + report.socket.overflowed;
  told.clock_sure = report.clock.locked;
  if (says(pose, StatusReason::kInnovation)) told.use = Use::kDoubted;
  if (says(pose, StatusReason::kNoLidar)) told.use = Use::kRefused;
  return told;
}

SensorEvidence evidence(const ImuReport& report, const std::optional<PoseSample>& pose) {
  SensorEvidence told = serial_evidence(report, report.source.bytes, report.samples);
  told.lost = report.parser.missing;
  told.clock_sure = report.clock.locked;
  if (says(pose, StatusReason::kImuContradicted)) told.use = Use::kDoubted;
  if (says(pose, StatusReason::kNoImu)) told.use = Use::kRefused;
  return told;
}

SensorEvidence evidence(const GnssReport& report, const std::optional<GnssState>& gnss) {
  SensorEvidence told = serial_evidence(report, report.serial.bytes, report.fixes);
  told.good = report.sentences.sentences;  // of which a fix is made of several
  told.spoke = instant(report.sentences.sentences > 0, report.last_sentence);
  if (gnss && gnss->trust == GnssTrust::kDoubtful) told.use = Use::kDoubted;
  if (report.is_stuck || (gnss && gnss->trust == GnssTrust::kFaulty)) told.use = Use::kRefused;
  return told;
}

SourceHealth judged(SourceHealth health, const SensorCondition& condition) {
  health.state = name(condition.state);
  health.reason = name(condition.defect);
  health.state_since = condition.since;
  health.times_faulty = condition.times_faulty;
  return health;
}

}  // namespace slamd
