#include "daemon/threads/rplidar_thread.hpp"

#include "daemon/server/host_clock.hpp"

namespace slamd {
namespace {

constexpr Duration kLongestWait = std::chrono::milliseconds{50};
constexpr Duration kUsbLatency = std::chrono::microseconds{500};

RplidarParser::Config parser_config(const LidarThreadConfig& config, const LidarDecoderConfig& decoder) {
  return {decoder.min_range_m, decoder.max_range_m, std::max(decoder.clock.min_latency, kUsbLatency), config.serial.baud};
}

}  // namespace

RplidarThread::RplidarThread(const LidarThreadConfig& config, const LidarDecoderConfig& decoder, Streams& streams)
    : source_{config.serial}, parser_{parser_config(config, decoder)}, streams_{streams} {}

void RplidarThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    ask();
    const SourceRead read = source_.read(kLongestWait);
    if (!read.bytes.empty()) take(read.bytes, read.arrival);
    note();
    tell();
  }
  const RplidarRequest request = rplidar_request(RplidarCommand::kStop);
  source_.write(request.view());
  source_.write(rplidar_motor_request(0).view());
}

/// A port that was opened since the last time is a sensor that knows nothing.
void RplidarThread::ask() {
  if (!source_.is_open()) return;
  if (source_.stats().openings != openings_) {
    openings_ = source_.stats().openings;
    parser_.restart();
    session_.restart();
  }
  while (const std::optional<RplidarRequest> request = session_.poll(host_now())) source_.write(request->view());
}

void RplidarThread::take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING {
  if (tap_ != nullptr) tap_->take({.payload = bytes, .arrival = arrival, .source = {}});
  now_.last_received = arrival;
  const std::uint64_t before = parser_.reader_stats().packets;
  parser_.feed(
      bytes, arrival,
      [this](const LaserScan& scan) { streams_.laser.try_push(scan); },
      [&](const RplidarPacket& packet) { session_.take(packet, arrival); });
  if (parser_.reader_stats().packets == before) return;
  session_.heard(arrival);
  now_.packets = parser_.reader_stats().packets;
  now_.last_arrival = arrival;
}

void RplidarThread::note() {
  const RplidarReaderStats& reader = parser_.reader_stats();
  LidarStats& told = now_.decoder;
  told.received = reader.packets + reader.bad_checksum;
  told.accepted = reader.packets;
  told.lost = parser_.gaps();
  told.points = parser_.stats().samples;
  told.out_of_range = parser_.stats().out_of_range;
  told.rejections = {};
  told.rejections.add(LidarRejection::kChecksum, reader.bad_checksum);
  if (parser_.clock()) now_.clock = {.locked = parser_.clock()->locked(), .sigma_s = to_seconds(parser_.clock()->sigma()), .jumps = parser_.clock()->jumps()};
}

}  // namespace slamd
