#pragma once
// Gathers the messages of one UTC epoch. It does not judge them: NmeaParser makes a fix of an epoch, or not.

#include <cstdint>
#include <optional>

#include "drivers/gnss/cycle_learner.hpp"
#include "drivers/gnss/nmea_messages.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// What a receiver said about one instant.
struct GnssEpoch {
  Duration time_of_day{};         // UTC
  HostTime first_arrival;         // of its first sentence with a time: the least delayed
  HostTime last_arrival;          // of its newest sentence
  std::optional<GgaMessage> gga;  // with several talkers the one of most satellites
  std::optional<RmcMessage> rmc;
  std::optional<GstMessage> gst;
  std::optional<GsaMessage> gsa;  // highest dimension of several; sent rarely: the last one, up to kKeptEpochs old
  std::optional<VtgMessage> vtg;
  std::optional<std::chrono::sys_days> date;
};

/// One thread uses an instance; no allocation. For each message call close_before() and then add(): each may complete
/// an epoch. An epoch is complete with the sentence that usually ends the cycle, or when the next cycle begins.
/// Sentences without a time that come after a pause belong to the next epoch, others to the running one.
class EpochAssembler {
 public:
  /// The running epoch, when `message` begins another cycle and the running one was not given yet.
  std::optional<GnssEpoch> close_before(const NmeaMessage& message, HostTime arrival);
  /// Takes the message; returns the epoch that it completes.
  std::optional<GnssEpoch> add(const NmeaMessage& message, HostTime arrival);
  /// The running epoch at the end of a stream.
  std::optional<GnssEpoch> close();

  /// Cycles that told a time that was given already.
  std::uint64_t repeated() const { return repeated_; }
  /// Sentences of an earlier epoch than the running one, ignored.
  std::uint64_t late() const { return late_; }

 private:
  static constexpr std::uint32_t kKeptEpochs = 12;
  enum class Relation : std::uint8_t { kSame, kNew, kLeading, kLate, kUntimed };

  Relation relation(const NmeaMessage& message, HostTime arrival) const;
  void open(Duration time_of_day, HostTime arrival);
  void merge(const NmeaMessage& message);
  GnssEpoch give();

  CycleLearner cycle_;
  GnssEpoch epoch_;
  bool open_ = false;                          // epoch_ has a time
  bool given_ = false;                         // and was handed out
  bool leading_ = false;                       // sentences of the next cycle have come already
  Duration period_ = std::chrono::seconds{1};  // between the last two epochs
  std::uint32_t gsa_age_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace slamd
