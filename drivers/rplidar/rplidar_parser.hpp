#pragma once
// Bytes of an RPLIDAR's serial port to laser scans in host time. It neither reads the port nor sends commands (rplidar_session).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/io/clock_sync.hpp"
#include "drivers/rplidar/rplidar_reader.hpp"
#include "drivers/rplidar/rplidar_unpacker.hpp"
#include "estimator/types/laser_scan.hpp"

namespace slamd {

/// Counters since construction; the reader's own are beside them.
struct RplidarStats {
  std::uint64_t scans = 0;
  std::uint64_t samples = 0;
  std::uint64_t out_of_range = 0;  // returns dropped by the range limits; no-returns are not counted
  std::uint64_t too_many = 0;      // samples of a revolution that did not end in time
};

/// One thread uses an instance; no allocation after construction.
class RplidarParser {
 public:
  static constexpr std::size_t kMaxBeams = 8192;  // 8,000 a second, one revolution a second

  struct Config {
    double min_range_m = 0.15;
    double max_range_m = 16.0;
    Duration latency = std::chrono::microseconds{500};  // smallest delay from the last bit on the wire to its arrival
    std::uint32_t baud = 115'200;                       // a packet takes so long on the wire: ten bits a byte
    static Config defaults() { return {}; }
  };

  explicit RplidarParser(const Config& config = Config::defaults());

  /// Takes the bytes of one read of the port, any split of the stream. Calls sink(const LaserScan&) for each revolution, from the
  /// second time on that the head passes its zero, and told(const RplidarPacket&) for every answer and for the begin of a stream.
  template <class Sink, class Told>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink, Told&& told) {
    for (const std::uint8_t byte : bytes) {
      const std::optional<RplidarPacket> packet = reader_.take(byte);
      if (!packet) continue;
      const bool is_measurement = !packet->bytes.empty() && packet->answer >= RplidarAnswer::kScan;
      if (!is_measurement) {
        note(*packet);
        told(*packet);
        continue;
      }
      for (const RplidarSample& sample : timed(*packet, arrival)) {
        if (add(sample, arrival)) sink(scan_);
      }
    }
  }
  /// The same for who asks nothing of the sensor: a recording.
  template <class Sink>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink) {
    feed(bytes, arrival, sink, [](const RplidarPacket&) {});
  }
  /// The port was opened anew.
  void restart();

  const RplidarStats& stats() const { return stats_; }
  const RplidarReaderStats& reader_stats() const { return reader_.stats(); }
  std::uint64_t gaps() const { return unpacker_.gaps(); }
  /// Of the running stream; nothing before one.
  const std::optional<ClockSync>& clock() const { return clock_; }

 private:
  void note(const RplidarPacket& packet);
  void begin_stream(RplidarAnswer answer);
  Duration period_of(RplidarAnswer answer) const;
  std::span<const RplidarSample> timed(const RplidarPacket& packet, HostTime arrival);
  bool add(const RplidarSample& sample, HostTime arrival);

  Config config_;
  RplidarReader reader_;
  RplidarUnpacker unpacker_;
  std::optional<Duration> told_period_;     // of a sample, by the sensor, in its typical mode
  std::optional<RplidarSampleRate> rates_;  // likewise of the older modes
  Duration period_{};
  Duration packet_period_{};
  std::optional<ClockSync> clock_;
  DeviceTime counted_;       // samples so far, in time
  HostTime packet_arrival_;  // of the newest packet,
  HostTime packet_end_;      // and when its last sample was taken
  HostTime sample_time_;  // of the next sample handed to add()
  LaserScan open_, scan_;
  bool is_open_ = false;
  RplidarStats stats_;
};

}  // namespace slamd
