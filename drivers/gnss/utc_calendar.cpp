#include "drivers/gnss/utc_calendar.hpp"

namespace slamd {
namespace {

constexpr Duration kDay = std::chrono::hours{24};
constexpr Duration kGpsRollOver = std::chrono::weeks{1024};
constexpr Duration kNearMidnight = std::chrono::minutes{2};

}  // namespace

/// The instant of this time of day that is nearest to the last epoch.
GnssTime UtcCalendar::nearest(Duration time_of_day) const {
  const GnssTime midnight{std::chrono::floor<std::chrono::days>(last_->time_since_epoch())};
  GnssTime utc = midnight + time_of_day;
  if (utc - *last_ > kDay / 2) utc -= kDay;
  if (*last_ - utc > kDay / 2) utc += kDay;
  return utc;
}

std::optional<GnssTime> UtcCalendar::place(Duration time_of_day, std::optional<std::chrono::sys_days> date) {
  if (!date && !last_) return std::nullopt;
  GnssTime utc{};
  if (date) {
    utc = GnssTime{date->time_since_epoch()} + time_of_day;
    while (utc < not_before_) utc += kGpsRollOver;
    const bool near_midnight = time_of_day < kNearMidnight || time_of_day > kDay - kNearMidnight;
    if (last_ && near_midnight && abs(utc - nearest(time_of_day)) == kDay &&
        abs(nearest(time_of_day) - *last_) < kNearMidnight) {
      utc = nearest(time_of_day);
    }
  } else {
    utc = nearest(time_of_day);
  }
  last_ = utc;
  return utc;
}

}  // namespace slamd
