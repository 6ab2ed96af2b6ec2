#pragma once
// Reads gps.csv of a drive folder: lines "t_ns,sentence" through the driver's NMEA parser to fixes.

#include <cstdint>
#include <deque>
#include <istream>
#include <optional>
#include <string>

#include "drivers/gnss/nmea_parser.hpp"

namespace slamd::replay {

class GpsCsvReader {
 public:
  /// `lines` must outlive the reader.
  GpsCsvReader(std::istream& lines, const NmeaParser::Config& config) : lines_{lines}, parser_{config} {}

  /// The next fix, or nothing at the end. Bad lines are counted and skipped.
  std::optional<GnssFix> next();

  const NmeaParser& parser() const { return parser_; }
  std::uint64_t bad_lines() const { return bad_lines_; }

 private:
  bool read_line();

  std::istream& lines_;
  NmeaParser parser_;
  std::string line_;
  std::deque<GnssFix> fixes_;
  std::uint64_t bad_lines_ = 0;
  bool ended_ = false;
};

}  // namespace slamd::replay
