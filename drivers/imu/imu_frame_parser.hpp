#pragma once
// Bytes of the IMU's serial stream to IMU samples in SI units and host time. It does not read the port (SerialSource).

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/imu/packet_splitter.hpp"
#include "drivers/io/clock_sync.hpp"
#include "estimator/types/imu_sample.hpp"
#include "firmware/protocol/imu_frame.hpp"

namespace slamd {

/// Counters since construction.
struct ImuStats {
  std::uint64_t samples = 0;
  std::array<std::uint64_t, 5> rejected{};  // packets, by ImuFrameError; [0] stays zero
  std::uint64_t garbage_bytes = 0;          // bytes of rejected packets
  std::uint64_t replies = 0;                // packets of other kinds than samples: not for this parser
  std::uint64_t gaps = 0;                   // interruptions of the sequence,
  std::uint64_t missing = 0;                // samples they cost
  std::uint64_t repeated = 0;               // frames whose time did not advance
  std::uint64_t implausible = 0;  // stamps far from the expected that the next frame did not confirm, or first of such
  std::uint64_t sensor_faults = 0;  // frames without valid measurement, by their status
  std::uint64_t clipped = 0;
  std::uint64_t resets = 0;             // starts of the device after the first
  std::uint16_t dropped_at_device = 0;  // the device's own total, as sent
};

/// One thread uses an instance; no allocation.
class ImuFrameParser {
 public:
  struct Config {
    ClockSync::Config clock;                  // imu.latency_s is clock.min_latency
    Duration stamp_tolerance{2'000'000'000};  // device and host time since the last frame differ by less
    static Config defaults();
  };

  explicit ImuFrameParser(const Config& config = Config::defaults()) : config_{config}, clock_{config.clock} {}

  /// Takes the bytes of one read of the port, any split of the stream. Calls sink(const ImuSample&) for each sample in
  /// order. After any garbage the first whole frame behind a delimiter is found.
  template <class Sink>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink) {
    for (const std::uint8_t byte : bytes) {
      if (const std::optional<ImuFrame> frame = take(byte)) {
        if (const std::optional<ImuSample> sample = convert(*frame, arrival)) sink(*sample);
      }
    }
  }

  /// One byte; returns the frame that it completes. The lower half of feed(), without time and units.
  std::optional<ImuFrame> take(std::uint8_t byte);

  const ImuStats& stats() const { return stats_; }
  const ClockSync& clock() const { return clock_; }

 private:
  struct Stamp {
    DeviceTime device;
    HostTime arrival;
    std::uint16_t sequence;
  };

  std::optional<ImuSample> convert(const ImuFrame& frame, HostTime arrival);
  bool follows(const Stamp& earlier, const Stamp& later) const;
  bool accept_stamp(const Stamp& stamp);

  Config config_;
  ClockSync clock_;
  PacketSplitter splitter_;
  std::optional<Stamp> last_;
  std::optional<Stamp> suspect_;  // a stamp that did not follow last_; the next frame decides
  ImuStats stats_;
};

}  // namespace slamd
