#include "daemon/threads/gnss_thread.hpp"

#include "daemon/server/host_clock.hpp"

namespace slamd {
namespace {

constexpr Duration kStopLatency = std::chrono::milliseconds{50};

}  // namespace

void GnssThread::allow_faults() {
  constexpr WireFaultShape kShape{.delay = std::chrono::seconds{1}, .period = std::chrono::seconds{8}, .held_reads = 256,
                                  .read_bytes = 512};
  faults_ = std::make_unique<SensorFault<GnssValueFault>>(streams_.faults.gnss, kShape);
}

GnssThread::GnssThread(const GnssThreadConfig& config, const NmeaParser::Config& nmea, Streams& streams)
    : source_{config.serial}, parser_{nmea}, streams_{streams} {}

void GnssThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const SourceRead read = source_.read(kStopLatency);
    if (faults_ == nullptr) {
      take(read.bytes, read.arrival);
    } else {
      faults_->wire.pass(read.bytes, host_now(), [this](auto bytes, HostTime arrival) { take(bytes, arrival); });
    }
    now_.parser = parser_.stats();
    now_.sentences = parser_.sentence_stats();
    now_.serial = source_.stats();
    now_.device_open = source_.is_open();
    report_.store(now_);
  }
}

void GnssThread::take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING {
  if (!bytes.empty()) now_.last_bytes = arrival;
  if (tap_ != nullptr) tap_->take({.payload = bytes, .arrival = arrival, .source = {}});
  parser_.feed(bytes, arrival, [this](const GnssFix& fix) {
    if (faults_ == nullptr) return take(fix);
    if (const std::optional<GnssFix> failed = faults_->values.apply(fix)) take(*failed);
  });
  if (parser_.sentence_stats().sentences != now_.sentences.sentences) now_.last_sentence = arrival;
}

void GnssThread::take(const GnssFix& fix) {
  ++now_.fixes;
  streams_.gnss.try_push(fix);
  now_.last_arrival = fix.arrival;
  now_.is_stuck = fix.stale;
  if (fix.utc_valid) streams_.utc_offset_ns.store(to_ns(fix.utc) - to_ns(fix.time), std::memory_order_relaxed);
}

}  // namespace slamd
