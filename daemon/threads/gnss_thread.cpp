#include "daemon/threads/gnss_thread.hpp"

namespace slamd {
namespace {

constexpr Duration kStopLatency = std::chrono::milliseconds{50};

}  // namespace

GnssThread::GnssThread(const GnssThreadConfig& config, const NmeaParser::Config& nmea, Streams& streams)
    : source_{config.serial}, parser_{nmea}, streams_{streams} {}

void GnssThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const SourceRead read = source_.read(kStopLatency);
    if (!read.bytes.empty()) now_.last_bytes = read.arrival;
    if (tap_ != nullptr) tap_->take({.payload = read.bytes, .arrival = read.arrival, .source = {}});
    parser_.feed(read.bytes, read.arrival, [this](const GnssFix& fix) { take(fix); });
    if (parser_.sentence_stats().sentences != now_.sentences.sentences) now_.last_sentence = read.arrival;
    now_.parser = parser_.stats();
    now_.sentences = parser_.sentence_stats();
    now_.serial = source_.stats();
    now_.device_open = source_.is_open();
    report_.store(now_);
  }
}

void GnssThread::take(const GnssFix& fix) {
  streams_.gnss.try_push(fix);
  now_.last_arrival = fix.arrival;
  if (fix.utc_valid) streams_.utc_offset_ns.store(to_ns(fix.utc) - to_ns(fix.time), std::memory_order_relaxed);
}

}  // namespace slamd
