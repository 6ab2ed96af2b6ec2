#pragma once
// Bytes to checked NMEA 0183 sentences, split into fields. It knows addresses, not what fields mean.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/io/checked_line.hpp"

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

/// One thread uses an instance; no allocation. Takes any split of the stream: parts of lines, merged lines, garbage.
class NmeaTokenizer {
 public:
  /// One byte; the sentence that it completes.
  std::optional<NmeaSentence> take(std::uint8_t byte);

  const CheckedLineStats& stats() const { return lines_.stats(); }

 private:
  CheckedLineReader lines_;
};

}  // namespace slamd
