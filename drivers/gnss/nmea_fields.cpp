#include "drivers/gnss/nmea_fields.hpp"

#include <charconv>
#include <cmath>

namespace slamd::nmea {
namespace {

constexpr unsigned kFirstYear = 1980;
constexpr unsigned kLastYear = 2200;  // nanoseconds since 1970 end in 2262

template <class Integer>
std::optional<Integer> integer(std::string_view text) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// [d]ddmm.mmmm: the last two digits before the point are minutes.
std::optional<double> angle_deg(std::string_view value, std::size_t degree_digits, double limit_deg) {
  if (value.size() < degree_digits + 2 || value.find_first_not_of("0123456789") < degree_digits + 2)
    return std::nullopt;
  const std::optional<unsigned> degrees = integer<unsigned>(value.substr(0, degree_digits));
  const std::optional<double> minutes = non_negative(value.substr(degree_digits));
  if (!degrees || !minutes || *minutes >= 60.0) return std::nullopt;
  const double angle = *degrees + *minutes / 60.0;
  return angle <= limit_deg ? std::optional{angle} : std::nullopt;
}

std::optional<double> signed_by(std::optional<double> angle, char hemisphere, char positive, char negative) {
  if (!angle || (hemisphere != positive && hemisphere != negative)) return std::nullopt;
  return hemisphere == negative ? -*angle : *angle;
}

std::optional<std::chrono::sys_days> valid_date(int year, unsigned month, unsigned day) {
  const std::chrono::year_month_day date{std::chrono::year{year}, std::chrono::month{month}, std::chrono::day{day}};
  return date.ok() ? std::optional{std::chrono::sys_days{date}} : std::nullopt;
}

}  // namespace

std::optional<double> number(std::string_view field) {
  if (field.empty() || field.find_first_not_of("0123456789.-+") != std::string_view::npos) return std::nullopt;
  if (field.starts_with("+-")) return std::nullopt;
  if (field.front() == '+') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value, std::chars_format::fixed);
  if (error != std::errc{} || end != field.data() + field.size()) return std::nullopt;
  return value;
}

std::optional<double> non_negative(std::string_view field) {
  const std::optional<double> value = number(field);
  return value && *value >= 0.0 ? value : std::nullopt;
}

std::optional<unsigned> small_count(std::string_view field) {
  const std::optional<unsigned> value = integer<unsigned>(field);
  return value && *value <= 255U ? value : std::nullopt;
}

char letter(std::string_view field) {
  return field.size() == 1 ? field.front() : '\0';
}

std::optional<double> latitude_deg(std::string_view value, std::string_view hemisphere) {
  return signed_by(angle_deg(value, 2, 90.0), letter(hemisphere), 'N', 'S');
}

std::optional<double> longitude_deg(std::string_view value, std::string_view hemisphere) {
  return signed_by(angle_deg(value, 3, 180.0), letter(hemisphere), 'E', 'W');
}

std::optional<Duration> time_of_day(std::string_view field) {
  if (field.size() < 6) return std::nullopt;
  const auto hours = integer<unsigned>(field.substr(0, 2));
  const auto minutes = integer<unsigned>(field.substr(2, 2));
  const auto seconds = non_negative(field.substr(4));
  if (!hours || !minutes || !seconds || *hours > 23 || *minutes > 59 || *seconds >= 61.0) return std::nullopt;
  return std::chrono::hours{*hours} + std::chrono::minutes{*minutes} + from_seconds(*seconds);
}

std::optional<std::chrono::sys_days> date_ddmmyy(std::string_view field) {
  if (field.size() != 6) return std::nullopt;
  const auto day = integer<unsigned>(field.substr(0, 2));
  const auto month = integer<unsigned>(field.substr(2, 2));
  const auto year = integer<unsigned>(field.substr(4, 2));
  if (!day || !month || !year) return std::nullopt;
  return valid_date(static_cast<int>(*year) + (*year < 80 ? 2000 : 1900), *month, *day);
}

std::optional<std::chrono::sys_days> date(std::string_view day, std::string_view month, std::string_view year) {
  const auto d = integer<unsigned>(day);
  const auto m = integer<unsigned>(month);
  const auto y = integer<unsigned>(year);
  if (!d || !m || !y || *y < kFirstYear || *y > kLastYear) return std::nullopt;
  return valid_date(static_cast<int>(*y), *m, *d);
}

}  // namespace slamd::nmea
