#pragma once
// Values of single NMEA fields. An empty or malformed field has no value; nothing is guessed.

#include <chrono>
#include <optional>
#include <string_view>

#include "estimator/types/time.hpp"

namespace slamd::nmea {

/// A decimal number without exponent, the whole field.
std::optional<double> number(std::string_view field);
/// A number that is not negative (dilutions, sigmas, speeds).
std::optional<double> non_negative(std::string_view field);
/// An unsigned integer up to 255, e.g. satellites.
std::optional<unsigned> small_count(std::string_view field);
/// The only character of the field; 0 when it has none or more.
char letter(std::string_view field);

/// ddmm.mmmm and N or S, to degrees, north positive, within +-90.
std::optional<double> latitude_deg(std::string_view value, std::string_view hemisphere);
/// dddmm.mmmm and E or W, to degrees, east positive, within +-180.
std::optional<double> longitude_deg(std::string_view value, std::string_view hemisphere);

/// hhmmss with any fraction, to the time since midnight UTC. A leap second (60) is allowed.
std::optional<Duration> time_of_day(std::string_view field);
/// ddmmyy; years 80..99 are of the last century.
std::optional<std::chrono::sys_days> date_ddmmyy(std::string_view field);
std::optional<std::chrono::sys_days> date(std::string_view day, std::string_view month, std::string_view year);

}  // namespace slamd::nmea
