#pragma once
// Datagrams of the IMU that is built into an Airy to samples in host time. It reads no socket; one packet's bytes are airy_imu_packet's.

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/io/clock_sync.hpp"
#include "drivers/io/packet_timeline.hpp"
#include "estimator/types/imu_sample.hpp"

namespace slamd {

/// Counters since construction.
struct AiryImuStats {
  std::uint64_t samples = 0;
  std::uint64_t malformed = 0;    // not an IMU packet, or with what no such IMU measures
  std::uint64_t repeated = 0;     // or late
  std::uint64_t implausible = 0;  // stamps that contradict the arrival; believed when the next one confirms it
  std::uint64_t missing = 0;      // by the stamps
  std::uint64_t resets = 0;       // of the sensor's clock
  std::uint64_t clipped = 0;
};

/// One thread uses an instance; no allocation. Samples are in the IMU's own frame (AiryDevice says where that is).
class AiryImuParser {
 public:
  struct Config {
    ClockSync::Config clock;                  // imu.latency_s is clock.min_latency
    Duration stamp_tolerance{2'000'000'000};  // stamp's advance against arrival's
    static Config defaults();
  };

  explicit AiryImuParser(const Config& config = Config::defaults())
      : timeline_{config.stamp_tolerance}, clock_{config.clock} {}

  /// One datagram of the IMU port, any bytes. Calls sink(const ImuSample&) when it holds a sample.
  template <class Sink>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink) {
    if (const std::optional<ImuSample> sample = take(bytes, arrival)) sink(*sample);
  }

  const AiryImuStats& stats() const { return stats_; }
  const ClockSync& clock() const { return clock_; }

 private:
  std::optional<ImuSample> take(std::span<const std::uint8_t> bytes, HostTime arrival);

  PacketTimeline timeline_;
  ClockSync clock_;
  AiryImuStats stats_;
};

}  // namespace slamd
