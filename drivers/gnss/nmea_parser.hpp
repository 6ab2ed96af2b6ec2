#pragma once
// Bytes of a GNSS receiver's NMEA stream to fixes in host time with the sigma that is believed. It does not read ports,
// project to a plane or gate fixes.

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/gnss/epoch_assembler.hpp"
#include "drivers/gnss/gnss_noise.hpp"
#include "drivers/gnss/nmea_sentence.hpp"
#include "drivers/gnss/utc_calendar.hpp"
#include "drivers/io/clock_sync.hpp"
#include "estimator/types/gnss_fix.hpp"

namespace slamd {

/// Counters since construction; the tokenizer's own are beside them.
struct GnssStats {
  std::uint64_t fixes = 0;
  std::uint64_t epochs_without_fix = 0;  // the receiver said that it has none
  std::uint64_t stale = 0;               // fixes marked GnssFix::stale
};

/// One thread uses an instance; no allocation.
class NmeaParser {
 public:
  struct Config {
    ClockSync::Config clock;  // gnss.latency_s is clock.min_latency: UTC of the fix to its first byte
    GnssNoiseConfig noise;
    GnssTime not_before = kNmeaYear2020;  // dates before are 1,024 weeks late (GPS week roll-over)
    static Config defaults();
  };

  explicit NmeaParser(const Config& config = Config::defaults())
      : config_{config}, clock_{config.clock}, calendar_{config.not_before} {}

  /// Takes the bytes of one read, any split of the stream. Calls sink(const GnssFix&) for each fix, in order.
  template <class Sink>
  void feed(std::span<const std::uint8_t> bytes, HostTime arrival, Sink&& sink) {
    for (const std::uint8_t byte : bytes) {
      const std::optional<NmeaSentence> sentence = tokenizer_.take(byte);
      const std::optional<NmeaMessage> message = sentence ? decode(*sentence) : std::nullopt;
      if (!message) continue;
      if (const auto fix = make_fix(epochs_.close_before(*message, arrival), arrival)) sink(*fix);
      if (const auto fix = make_fix(epochs_.add(*message, arrival), arrival)) sink(*fix);
    }
  }

  /// The fix of the last epoch, at the end of a recording.
  template <class Sink>
  void finish(Sink&& sink) {
    const std::optional<GnssEpoch> last = epochs_.close();
    if (const auto fix = make_fix(last, last ? last->last_arrival : HostTime{})) sink(*fix);
  }

  const GnssStats& stats() const { return stats_; }
  const CheckedLineStats& sentence_stats() const { return tokenizer_.stats(); }
  const EpochAssembler& epochs() const { return epochs_; }
  const ClockSync& clock() const { return clock_; }

 private:
  std::optional<GnssFix> make_fix(const std::optional<GnssEpoch>& epoch, HostTime completed);
  void place_in_time(const GnssEpoch& epoch, GnssFix& fix);
  bool is_stale(const GnssFix& fix);

  Config config_;
  NmeaTokenizer tokenizer_;
  EpochAssembler epochs_;
  CounterUnwrapper day_{std::chrono::hours{24}};
  ClockSync clock_;
  UtcCalendar calendar_;
  GnssFix last_;
  std::uint32_t unchanged_ = 0;  // fixes in a row at the very place of last_
  GnssStats stats_;
};

}  // namespace slamd
