#pragma once
// Finds lines "$...*hh" with a right checksum (XOR of all between) in a stream of bytes, as NMEA 0183 has them. It does not know
// what a line says.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamd {

/// Counters since construction.
struct CheckedLineStats {
  std::uint64_t sentences = 0;  // with a right checksum, of any type
  std::uint64_t bad_checksum = 0;
  std::uint64_t no_checksum = 0;  // ended before "*hh"
  std::uint64_t broken = 0;       // another '$' or a byte that is not text inside
  std::uint64_t too_long = 0;
  std::uint64_t ignored_bytes = 0;  // outside lines
};

/// One thread uses an instance; no allocation. Takes any split of the stream: parts of lines, merged lines, garbage.
class CheckedLineReader {
 public:
  /// NMEA allows 82; receivers with many digits send more.
  static constexpr std::size_t kMaxLength = 160;

  /// One byte; the text between '$' (or '!') and '*' of the line that it completes, valid until the next call. A line is
  /// complete with the second digit of its checksum.
  std::optional<std::string_view> take(std::uint8_t byte);

  const CheckedLineStats& stats() const { return stats_; }

 private:
  enum class State : std::uint8_t { kOutside, kBody, kChecksumHigh, kChecksumLow };

  void take_body(std::uint8_t byte);
  std::optional<std::string_view> finish(std::uint8_t byte);
  void abandon(std::uint64_t CheckedLineStats::*cause);

  State state_ = State::kOutside;
  std::array<char, kMaxLength> body_{};
  std::size_t length_ = 0;
  std::uint8_t sum_ = 0;
  std::uint8_t expected_ = 0;
  CheckedLineStats stats_;
};

}  // namespace slamd
