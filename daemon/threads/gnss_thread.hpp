#pragma once
// The GPS receiver's thread: serial bytes to fixes in the ring. Real-time like its brothers; it judges no fix beyond
// what the sentence says.

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "daemon/inject/sensor_fault.hpp"
#include "daemon/ring/latest_value.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/streams.hpp"
#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/io/serial_source.hpp"

namespace slamd {

struct GnssThreadConfig {
  SerialSourceConfig serial{.path = "/dev/ttyACM1", .baud = 9600};
};

/// What the thread has seen; totals since the start.
struct GnssReport {
  HostTime last_arrival;   // of the newest fix; only meaningful when fixes > 0
  std::uint64_t fixes = 0;  // handed on
  HostTime last_bytes;     // of the newest bytes, whatever they were
  HostTime last_sentence;  // of the newest bytes that ended a sentence; only meaningful when sentences.sentences > 0
  GnssStats parser;
  CheckedLineStats sentences;
  SourceStats serial;
  bool device_open = false;
  bool is_stuck = false;   // the newest fix repeats the one before, though the vehicle moves
};

class GnssThread {
 public:
  /// streams must outlive it.
  GnssThread(const GnssThreadConfig& config, const NmeaParser::Config& nmea, Streams& streams);

  /// Before run(): every read of the port goes to `tap` as well, which must outlive the thread.
  void record_to(WireTap& tap) { tap_ = &tap; }
  /// Before run(): failures may be played on this sensor.
  void allow_faults();
  /// The thread's body: returns within a tenth of a second after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  GnssReport report() const { return report_.load().value_or(GnssReport{}); }

 private:
  void take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING;
  void take(const GnssFix& fix);

  SerialSource source_;
  NmeaParser parser_;
  Streams& streams_;
  WireTap* tap_ = nullptr;
  std::unique_ptr<SensorFault<GnssValueFault>> faults_;  // null: none may be played
  GnssReport now_;
  LatestValue<GnssReport> report_;
};

}  // namespace slamd
