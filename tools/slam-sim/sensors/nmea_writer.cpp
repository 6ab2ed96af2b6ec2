#include "tools/slam-sim/sensors/nmea_writer.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <string_view>
#include <utility>

namespace slamd::sim {
namespace {

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
  char text[128];
  va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return {text, static_cast<std::size_t>(std::min(length, static_cast<int>(sizeof text) - 1))};
}

struct Civil {
  int year;
  unsigned month, day;
  int hour, minute;
  double second;
};

Civil civil(double utc_s) {
  using namespace std::chrono;
  const sys_time<milliseconds> at{milliseconds{std::llround(utc_s * 100.0) * 10}};
  const auto day = floor<days>(at);
  const year_month_day date{day};
  const hh_mm_ss time{at - day};
  return {static_cast<int>(date.year()),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<int>(time.hours().count()),
          static_cast<int>(time.minutes().count()),
          static_cast<double>(time.seconds().count()) + static_cast<double>(time.subseconds().count()) * 1e-3};
}

std::string clock_text(const Civil& t) {
  return print("%02d%02d%05.2f", t.hour, t.minute, t.second);
}

/// ddmm.mmmmm,N with a width of degrees; rounding never shows 60 minutes.
std::string angle(double degrees, int width, char positive, char negative) {
  const long long parts = std::llround(std::abs(degrees) * 60.0 * 1e5);
  const long long whole = parts / 6'000'000;
  const double minutes = static_cast<double>(parts % 6'000'000) * 1e-5;
  return print("%0*lld%08.5f,%c", width, whole, minutes, degrees < 0.0 ? negative : positive);
}

std::string position(const NmeaFix& fix) {
  if (fix.quality == 0) return ",,,";
  return angle(fix.latitude_deg, 2, 'N', 'S') + "," + angle(fix.longitude_deg, 3, 'E', 'W');
}

using Writer = std::string (*)(const NmeaFix&);
constexpr std::array<std::pair<std::string_view, Writer>, 6> kWriters{
    {{"GGA", &gga}, {"RMC", &rmc}, {"GSA", &gsa}, {"GST", &gst}, {"VTG", &vtg}, {"ZDA", &zda}}};

const Writer* writer_of(std::string_view kind) {
  for (const auto& [name, writer] : kWriters) {
    if (name == kind) return &writer;
  }
  return nullptr;
}

}  // namespace

bool is_sentence(const std::string& kind) {
  return writer_of(kind) != nullptr;
}

std::string sentence(const std::string& kind, const NmeaFix& fix) {
  const Writer* writer = writer_of(kind);
  return writer != nullptr ? (*writer)(fix) : std::string{};
}

std::string framed(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return "$" + body + print("*%02X\r\n", sum);
}

std::string gga(const NmeaFix& fix) {
  const std::string head = "GPGGA," + clock_text(civil(fix.utc_s)) + "," + position(fix);
  if (fix.quality == 0) return framed(head + ",0,00,99.99,,,,,,");
  return framed(head + print(",%d,%02d,%.2f,%.1f,M,%.1f,M,,", fix.quality, fix.satellites, fix.hdop, fix.altitude_msl_m,
                             fix.geoid_separation_m));
}

std::string rmc(const NmeaFix& fix) {
  const Civil t = civil(fix.utc_s);
  const std::string date = print("%02u%02u%02d", t.day, t.month, t.year % 100);
  if (fix.quality == 0) return framed("GPRMC," + clock_text(t) + ",V,,,,,,," + date + ",,,N");
  const double knots = fix.speed_mps / 0.514444;
  const std::string course = fix.speed_mps > 0.5 ? print("%.2f", fix.course_deg) : "";  // receivers name none at rest
  return framed("GPRMC," + clock_text(t) + ",A," + position(fix) + print(",%.3f,", knots) + course + "," + date +
                ",,,A");
}

std::string gsa(const NmeaFix& fix) {
  static constexpr int kIds[] = {2, 4, 5, 9, 12, 16, 18, 20, 25, 26, 29, 31};
  std::string ids;
  for (int i = 0; i < 12; ++i) ids += fix.quality != 0 && i < fix.satellites ? print("%02d,", kIds[i]) : ",";
  if (fix.quality == 0) return framed("GPGSA,A,1," + ids + "99.99,99.99,99.99");
  return framed("GPGSA,A,3," + ids + print("%.2f,%.2f,%.2f", 1.8 * fix.hdop, fix.hdop, 1.5 * fix.hdop));
}

std::string gst(const NmeaFix& fix) {
  const std::string head = "GPGST," + clock_text(civil(fix.utc_s));
  if (fix.quality == 0) return framed(head + ",,,,,,,");
  const double h = fix.sigma_horizontal_m;
  return framed(head + print(",%.1f,%.1f,%.1f,45.0,%.1f,%.1f,%.1f", 4.5 * h, h, h, h, h, fix.sigma_vertical_m));
}

std::string vtg(const NmeaFix& fix) {
  if (fix.quality == 0) return framed("GPVTG,,T,,M,,N,,K,N");
  const std::string course = fix.speed_mps > 0.5 ? print("%.2f", fix.course_deg) : "";
  return framed("GPVTG," + course + print(",T,,M,%.3f,N,%.3f,K,A", fix.speed_mps / 0.514444, fix.speed_mps * 3.6));
}

std::string zda(const NmeaFix& fix) {
  const Civil t = civil(fix.utc_s);
  return framed("GPZDA," + clock_text(t) + print(",%02u,%02u,%04d,00,00", t.day, t.month, t.year));
}

}  // namespace slamd::sim
