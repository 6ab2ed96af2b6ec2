#pragma once
// The thread of the wheels: lines of their serial port, and readings that clients send over the socket, to odometry in the ring.
// Real-time like its brothers; it estimates nothing.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>

#include "daemon/ring/latest_value.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/streams.hpp"
#include "drivers/io/serial_source.hpp"
#include "drivers/wheel/wheel_parser.hpp"

namespace slamd {

struct WheelThreadConfig {
  SerialSourceConfig serial{.path = "", .baud = 115'200};  // an empty path: no port, but readings may come over the socket
  WheelTrackConfig track = WheelTrackConfig::defaults();
};

/// What the thread has seen; totals since the start.
struct WheelReport {
  HostTime last_arrival;  // of the newest odometry; only meaningful when odometries > 0
  std::uint64_t odometries = 0;  // handed on
  std::uint64_t pushed = 0;      // readings that came over the socket
  WheelParserStats parser;
  CheckedLineStats lines;
  WheelTrackStats track;
  SourceStats serial;
  bool device_open = false;
};

class WheelThread {
 public:
  /// streams must outlive it.
  WheelThread(const WheelThreadConfig& config, Streams& streams);

  /// Before run(): every read goes to `tap` as well, which must outlive the thread. A reading that was pushed is recorded as the line
  /// that would have said it.
  void record_to(WireTap& tap) { tap_ = &tap; }
  /// The server's thread: a reading of a client, which arrived then. Wait-free. False when it is impossible or too many wait.
  bool push(const WheelReading& reading, HostTime arrival);
  /// The thread's body: returns within a tenth of a second after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  WheelReport report() const { return report_.load().value_or(WheelReport{}); }

 private:
  struct Pushed {
    std::array<char, 128> line;
    std::size_t size;
    HostTime arrival;
  };
  void take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING;
  void tell();

  SerialSource source_;
  bool has_port_;
  WheelParser parser_;
  SpscRing<Pushed> pushed_{256};
  Streams& streams_;
  WireTap* tap_ = nullptr;
  WheelReport now_;
  LatestValue<WheelReport> report_;
};

}  // namespace slamd
