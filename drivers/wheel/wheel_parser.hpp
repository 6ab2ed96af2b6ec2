#pragma once
// Bytes of the wheels' serial port to wheel odometry in host time. It does not read the port (drivers/io/serial_source).

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/io/checked_line.hpp"
#include "drivers/wheel/wheel_track.hpp"

namespace slamd {

/// Counters since construction; those of lines and of the track are beside them.
struct WheelParserStats {
  std::uint64_t other = 0;      // whole lines of another kind
  std::uint64_t malformed = 0;  // of ours, with a right checksum, whose fields are not what they should be
};

/// One thread uses an instance; no allocation.
class WheelParser {
 public:
  using Config = WheelTrackConfig;

  explicit WheelParser(const Config& config = Config::defaults()) : track_{config} {}

  /// Takes the bytes of one read, any split of the stream. Calls sink(const WheelOdometry&) for each reading that is
  /// believed, in order.
  template <class Sink>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink) {
    for (const std::uint8_t byte : bytes) {
      const std::optional<WheelReading> reading = take(byte);
      if (!reading) continue;
      if (const std::optional<WheelOdometry> odometry = track_.add(*reading, arrival)) sink(*odometry);
    }
  }

  /// One byte; returns the reading that it completes. The lower half of feed(), without time.
  std::optional<WheelReading> take(std::uint8_t byte);

  const WheelParserStats& stats() const { return stats_; }
  const CheckedLineStats& line_stats() const { return lines_.stats(); }
  const WheelTrackStats& track_stats() const { return track_.stats(); }
  const ClockSync& clock() const { return track_.clock(); }

 private:
  CheckedLineReader lines_;
  WheelTrack track_;
  WheelParserStats stats_;
};

}  // namespace slamd
