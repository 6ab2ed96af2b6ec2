#include "daemon/threads/source_health.hpp"

#include <array>
#include <cstddef>

namespace slamd {
namespace {

constexpr Duration kSilentAfter = std::chrono::seconds{1};
constexpr Duration kGnssSilentAfter = std::chrono::seconds{3};  // some receivers speak once a second, and late

bool is_fresh(std::uint64_t received, HostTime last_arrival, HostTime now, Duration limit) {
  return received > 0 && now - last_arrival <= limit;
}

void add_rejected(SourceHealth& health, const char* cause, std::uint64_t count) {
  if (count > 0) health.rejected.emplace_back(cause, count);
}

}  // namespace

SourceHealth source_health(const LidarReport& report, HostTime now) {
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.decoder.accepted;
  health.lost = report.decoder.lost + report.socket.overflowed;
  report.decoder.rejections.for_each(
      [&](const char* cause, std::uint64_t count) { add_rejected(health, cause, count); });
  add_rejected(health, "foreign_sender", report.socket.foreign);
  add_rejected(health, "oversized", report.socket.oversized);
  const bool datagrams = is_fresh(report.decoder.received, report.last_received, now, kSilentAfter);
  const bool packets = is_fresh(report.decoder.accepted, report.last_arrival, now, kSilentAfter);
  health.state = packets ? "healthy" : datagrams ? "refused" : "silent";
  return health;
}

SourceHealth source_health(const ImuReport& report, HostTime now) {
  constexpr std::array kCauses{"", "length", "cobs", "crc", "version"};
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.parser.samples;
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
  const bool samples = is_fresh(health.received, report.last_arrival, now, kSilentAfter);
  const bool bytes = is_fresh(report.source.bytes, report.last_bytes, now, kSilentAfter);
  health.state = !report.device_open ? "absent" : samples ? "healthy" : bytes ? "refused" : "silent";
  return health;
}

SourceHealth source_health(const GnssReport& report, HostTime now) {
  SourceHealth health;
  health.last_arrival = report.last_arrival;
  health.received = report.parser.fixes;
  add_rejected(health, "bad_checksum", report.sentences.bad_checksum);
  add_rejected(health, "no_checksum", report.sentences.no_checksum);
  add_rejected(health, "broken", report.sentences.broken);
  add_rejected(health, "too_long", report.sentences.too_long);
  add_rejected(health, "stale", report.parser.stale);
  const bool fixes = is_fresh(health.received, report.last_arrival, now, kGnssSilentAfter);
  const bool sentences = is_fresh(report.sentences.sentences, report.last_sentence, now, kGnssSilentAfter);
  health.state = !report.device_open ? "absent" : fixes ? "healthy" : sentences ? "no_fix" : "silent";
  return health;
}

}  // namespace slamd
