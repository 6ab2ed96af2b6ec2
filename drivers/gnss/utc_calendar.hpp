#pragma once
// The UTC date of epochs that carry a time of day and only sometimes a date. No clock is read.

#include <chrono>
#include <optional>

#include "estimator/types/time.hpp"

namespace slamd {

constexpr GnssTime kNmeaYear2020{std::chrono::sys_days{std::chrono::year{2020} / 1 / 1}.time_since_epoch()};

/// One thread uses an instance; no allocation.
class UtcCalendar {
 public:
  /// not_before  dates before it are moved on by whole roll-overs of the GPS week (1,024 weeks)
  explicit UtcCalendar(GnssTime not_before) : not_before_{not_before} {}

  /// UTC of an epoch. Without a date: the day that is nearest to the epoch before; nothing until a date was seen. A
  /// date that lags or leads by one day within two minutes of midnight is corrected: receivers change it a sentence
  /// late.
  std::optional<GnssTime> place(Duration time_of_day, std::optional<std::chrono::sys_days> date);

 private:
  GnssTime nearest(Duration time_of_day) const;

  GnssTime not_before_;
  std::optional<GnssTime> last_;
};

}  // namespace slamd
