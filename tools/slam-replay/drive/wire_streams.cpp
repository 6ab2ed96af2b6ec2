#include "tools/slam-replay/drive/wire_streams.hpp"

#include <array>

namespace slamd::replay {

void tell(const ImuFrameParser& parser, StreamReport& report) {
  constexpr std::array kCauses{"", "length", "cobs", "crc", "version"};
  const ImuStats& stats = parser.stats();
  report.missing = stats.missing;
  report.resets = stats.resets;
  report.clock_jumps = parser.clock().jumps();
  report.rejections.push_back({"imu", "repeated", stats.repeated});
  report.rejections.push_back({"imu", "implausible_stamp", stats.implausible});
  report.rejections.push_back({"imu", "sensor_fault", stats.sensor_faults});
  for (std::size_t i = 1; i < kCauses.size(); ++i) report.rejections.push_back({"imu", kCauses[i], stats.rejected[i]});
}

void tell(const NmeaParser& parser, StreamReport& report) {
  const auto& sentences = parser.sentence_stats();
  report.rejections.push_back({"gps", "bad_checksum", sentences.bad_checksum});
  report.rejections.push_back({"gps", "no_checksum", sentences.no_checksum});
  report.rejections.push_back({"gps", "broken", sentences.broken});
  report.rejections.push_back({"gps", "too_long", sentences.too_long});
  report.rejections.push_back({"gps", "stale", parser.stats().stale});
}

void tell(const WheelParser& parser, StreamReport& report) {
  const CheckedLineStats& lines = parser.line_stats();
  report.resets = parser.track_stats().restarts;
  report.rejections.push_back({"wheel", "bad_checksum", lines.bad_checksum});
  report.rejections.push_back({"wheel", "no_checksum", lines.no_checksum});
  report.rejections.push_back({"wheel", "broken", lines.broken});
  report.rejections.push_back({"wheel", "too_long", lines.too_long});
  report.rejections.push_back({"wheel", "malformed", parser.stats().malformed});
  parser.track_stats().rejections.for_each(
      [&](const char* cause, std::uint64_t count) { report.rejections.push_back({"wheel", cause, count}); });
}

void tell(const RplidarParser& parser, StreamReport& report) {
  report.missing = parser.gaps();
  report.rejections.push_back({"lidar", "bad_checksum", parser.reader_stats().bad_checksum});
  report.rejections.push_back({"lidar", "garbage_bytes", parser.reader_stats().garbage_bytes});
  report.rejections.push_back({"lidar", "too_many_samples", parser.stats().too_many});
}

void tell(const AiryImuParser& parser, StreamReport& report) {
  const AiryImuStats& stats = parser.stats();
  report.missing = stats.missing;
  report.resets = stats.resets;
  report.clock_jumps = parser.clock().jumps();
  report.rejections.push_back({"imu", "malformed", stats.malformed});
  report.rejections.push_back({"imu", "repeated", stats.repeated});
  report.rejections.push_back({"imu", "implausible_stamp", stats.implausible});
}

const LidarPacket* SpinningStream::next() {
  while (const UdpPacket* read = reads_->next()) {
    const std::uint16_t port = read->destination_port;
    if (port != 0 && port == ports_.side) lidar_.side(read->payload);
    if (port != 0 && port != ports_.points) continue;
    if (const LidarPacket* packet = lidar_.points(read->payload, read->arrival)) return packet;
  }
  return nullptr;
}

StreamReport SpinningStream::report() const {
  const LidarStats& stats = lidar_.stats();
  StreamReport report;
  report.items = stats.accepted;
  report.missing = stats.lost;
  report.clock_jumps = stats.clock_jumps;
  stats.rejections.for_each([&](const char* cause, std::uint64_t count) { report.rejections.push_back({"lidar", cause, count}); });
  reads_->tell(report);
  return report;
}

}  // namespace slamd::replay
