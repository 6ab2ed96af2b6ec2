#include "tests/endurance/nmea_clock.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace slamd::endurance {
namespace {

constexpr std::int64_t kDay_s = 86'400;

int number(const std::string& text, std::size_t at, std::size_t count) {
  return at + count <= text.size() ? std::atoi(text.substr(at, count).c_str()) : 0;
}

std::string two_digits(std::int64_t value) {
  char text[8];
  std::snprintf(text, sizeof text, "%02d", static_cast<int>(value));
  return text;
}

/// hhmmss and what follows. Gives the days that it went on.
std::int64_t move_time(std::string& time, std::int64_t by_s) {
  if (time.size() < 6) return 0;
  const std::int64_t moved = number(time, 0, 2) * 3600 + number(time, 2, 2) * 60 + number(time, 4, 2) + by_s;
  const std::int64_t of_day = moved % kDay_s;
  time.replace(0, 6, two_digits(of_day / 3600) + two_digits(of_day / 60 % 60) + two_digits(of_day % 60));
  return moved / kDay_s;
}

std::chrono::year_month_day later(int year, int month, int day, std::int64_t days) {
  using namespace std::chrono;
  const year_month_day date{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                            std::chrono::day{static_cast<unsigned>(day)}};
  return sys_days{date} + std::chrono::days{days};
}

void move_date(std::string& ddmmyy, std::int64_t days) {
  if (ddmmyy.size() != 6) return;
  const auto date = later(2000 + number(ddmmyy, 4, 2), number(ddmmyy, 2, 2), number(ddmmyy, 0, 2), days);
  ddmmyy = two_digits(unsigned{date.day()}) + two_digits(unsigned{date.month()}) + two_digits(int{date.year()} % 100);
}

std::vector<std::string> fields_of(const std::string& body) {
  std::vector<std::string> fields;
  std::istringstream stream{body};
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  if (body.ends_with(',')) fields.emplace_back();
  return fields;
}

std::string joined(const std::vector<std::string>& fields) {
  std::string body;
  for (const std::string& field : fields) body += (body.empty() ? "" : ",") + field;
  return body;
}

}  // namespace

void move_sentence(std::vector<std::uint8_t>& sentence, std::int64_t by_s) {
  const std::string text{sentence.begin(), sentence.end()};
  const std::size_t star = text.rfind('*');
  if (!text.starts_with('$') || star == std::string::npos) return;
  std::vector<std::string> fields = fields_of(text.substr(1, star - 1));
  const std::string kind = fields.front().size() == 5 ? fields.front().substr(2) : "";
  const bool timed = kind == "GGA" || kind == "RMC" || kind == "GST" || kind == "ZDA";
  if (!timed || fields.size() < 5) return;
  const std::int64_t days = move_time(fields[1], by_s);
  if (kind == "RMC" && fields.size() > 9) move_date(fields[9], days);
  if (kind == "ZDA") {
    const auto date = later(std::atoi(fields[4].c_str()), std::atoi(fields[3].c_str()), std::atoi(fields[2].c_str()), days);
    fields[2] = two_digits(unsigned{date.day()});
    fields[3] = two_digits(unsigned{date.month()});
    fields[4] = std::to_string(int{date.year()});
  }
  const std::string body = joined(fields);
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  char end[8];
  std::snprintf(end, sizeof end, "*%02X\r\n", sum);
  const std::string moved = '$' + body + end;
  sentence.assign(moved.begin(), moved.end());
}

}  // namespace slamd::endurance
