#pragma once
// Bytes to checked NMEA 0183 sentences, split into fields. It knows addresses and checksums, not what fields mean.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamd {

enum class NmeaType : std::uint8_t { kGga, kRmc, kGsa, kGst, kVtg, kZda, kOther };
constexpr std::size_t kNmeaTypes = 6;  // without kOther

/// One sentence with a right checksum. The views live until the tokenizer takes its next byte.
struct NmeaSentence {
  static constexpr std::size_t kMaxFields = 40;

  NmeaType type = NmeaType::kOther;
  std::string_view talker;                            // "GP", "GN", ...
  std::array<std::string_view, kMaxFields> fields{};  // after the address
  std::size_t count = 0;

  /// Field `i`, empty when the sentence is shorter.
  std::string_view field(std::size_t i) const { return i < count ? fields[i] : std::string_view{}; }
};

/// Counters since construction.
struct NmeaSentenceStats {
  std::uint64_t sentences = 0;  // with a right checksum, of any type
  std::uint64_t bad_checksum = 0;
  std::uint64_t no_checksum = 0;  // ended before "*hh"
  std::uint64_t broken = 0;       // another '$' or a byte that is not text inside
  std::uint64_t too_long = 0;
  std::uint64_t ignored_bytes = 0;  // outside sentences
};

/// One thread uses an instance; no allocation. Takes any split of the stream: parts of lines, merged lines, garbage.
class NmeaTokenizer {
 public:
  /// NMEA allows 82; receivers with many digits send more.
  static constexpr std::size_t kMaxLength = 160;

  /// One byte; the sentence that it completes. A sentence is complete with the second digit of its checksum.
  std::optional<NmeaSentence> take(std::uint8_t byte);

  const NmeaSentenceStats& stats() const { return stats_; }

 private:
  enum class State : std::uint8_t { kOutside, kBody, kChecksumHigh, kChecksumLow };

  void take_body(std::uint8_t byte);
  std::optional<NmeaSentence> finish(std::uint8_t byte);
  NmeaSentence split() const;
  void abandon(std::uint64_t NmeaSentenceStats::*cause);

  State state_ = State::kOutside;
  std::array<char, kMaxLength> body_{};
  std::size_t length_ = 0;
  std::uint8_t sum_ = 0;
  std::uint8_t expected_ = 0;
  NmeaSentenceStats stats_;
};

}  // namespace slamd
