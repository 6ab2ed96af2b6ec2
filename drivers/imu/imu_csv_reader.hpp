#pragma once
// Reads imu.csv of a drive folder: lines with arrival times only, to samples with reconstructed measurement times.

#include <cstdint>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/io/sample_clock.hpp"
#include "estimator/types/imu_sample.hpp"

namespace slamd {

/// A file can be read ahead: the clock is settled on the first kPrimeSamples, so that also the first times are good.
/// Format: t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c with one header line; temp_c may be missing.
class ImuCsvReader {
 public:
  static constexpr std::size_t kPrimeSamples = 2000;

  struct Stats {
    std::uint64_t samples = 0;
    std::uint64_t bad_lines = 0;     // not eight numbers, not finite, no host time
    std::uint64_t out_of_range = 0;  // values that no sensor gives
    std::uint64_t backward = 0;      // arrival before that of the line above
    std::uint64_t clipped = 0;
  };

  /// `lines` must outlive the reader.
  ImuCsvReader(std::istream& lines, const SampleClock::Config& config) : lines_{lines}, clock_{config} {}

  /// The next sample, or nothing at the end. Bad lines are counted and skipped.
  /// Times increase.
  std::optional<ImuSample> next();

  const Stats& stats() const { return stats_; }
  const SampleClock& clock() const { return clock_; }

 private:
  void prime();
  ImuSample advance();
  std::optional<ImuSample> read_line();
  std::optional<ImuSample> parse(std::string_view line);

  std::istream& lines_;
  SampleClock clock_;
  std::string line_;
  std::vector<ImuSample> primed_;  // the first samples, with their times
  std::size_t primed_given_ = 0;
  std::optional<ImuSample> ahead_;  // the line after the newest that the clock has seen
  std::optional<HostTime> newest_arrival_;
  bool started_ = false;
  Stats stats_;
};

}  // namespace slamd
