#pragma once
// Reads scan.csv of a drive folder: finished scans of a 2D LiDAR, one a line. It does not de-skew and knows no 3D LiDAR.

#include <istream>
#include <optional>
#include <string>
#include <string_view>

#include "estimator/types/laser_scan.hpp"
#include "estimator/types/result.hpp"
#include "tools/slam-replay/drive/bad_lines.hpp"

namespace slamd::replay {

/// t_ns,angle_begin_rad,angle_step_rad,beam_s,range_max_m,r0;r1;... with one header line. t_ns: arrival of the last beam, ns of
/// the host; beam_s: between two beams, 0 where nobody knows; ranges in metres in order of measurement, 0 = nothing returned.
class ScanCsvReader {
 public:
  static constexpr std::size_t kMostBeams = 16384;
  static constexpr double kLongestScanS = 10.0;

  /// `lines` must outlive the reader.
  explicit ScanCsvReader(std::istream& lines) : lines_{lines} {}

  /// The next scan, or nothing at the end. Bad lines are counted and skipped. Arrivals increase, unless
  /// the host's clock was set back by more than a second.
  std::optional<LaserScan> next();

  const BadLines& bad_lines() const { return bad_lines_; }

 private:
  Result<LaserScan> parse(std::string_view line) const;

  std::istream& lines_;
  std::string line_;
  std::uint64_t line_number_ = 0;
  std::optional<HostTime> newest_arrival_;
  BadLines bad_lines_;
};

}  // namespace slamd::replay
