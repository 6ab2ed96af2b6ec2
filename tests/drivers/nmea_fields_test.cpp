#include "drivers/gnss/nmea_fields.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace slamd::nmea {
namespace {

using namespace std::chrono_literals;

TEST(NmeaFields, LatitudesAndLongitudesInDegrees) {
  EXPECT_NEAR(*latitude_deg("4815.91801", "N"), 48.0 + 15.91801 / 60.0, 1e-12);
  EXPECT_NEAR(*latitude_deg("0000.0001", "S"), -0.0001 / 60.0, 1e-15);
  EXPECT_NEAR(*longitude_deg("17959.9999", "W"), -(179.0 + 59.9999 / 60.0), 1e-12);
  EXPECT_NEAR(*longitude_deg("01140", "E"), 11.0 + 40.0 / 60.0, 1e-12);
  EXPECT_EQ(latitude_deg("9000.000", "N"), 90.0);
}

TEST(NmeaFields, RefuseWhatIsNoAngle) {
  for (const std::string_view bad :
       {"", "4", "48", "9000.001", "4860.0", "48-1.0", "481a.0", "48.15", "4815.9.1", " 4815.9"}) {
    EXPECT_FALSE(latitude_deg(bad, "N")) << bad;
  }
  for (const std::string_view bad : {"", "E", "n", "NN"}) EXPECT_FALSE(latitude_deg("4815.9", bad)) << bad;
  EXPECT_FALSE(longitude_deg("18000.1", "E"));
  EXPECT_FALSE(longitude_deg("1140.28", "E").value_or(999.0) < 90.0);
}

TEST(NmeaFields, Numbers) {
  EXPECT_EQ(number("-31.442"), -31.442);
  EXPECT_EQ(number("+1"), 1.0);
  EXPECT_EQ(number("072.35"), 72.35);
  for (const std::string_view bad : {"", "-", ".", "1e5", "nan", "inf", "0x1", "1,2", "1-2", "+-1"})
    EXPECT_FALSE(number(bad)) << bad;
  EXPECT_FALSE(non_negative("-0.1"));
  EXPECT_EQ(small_count("08"), 8U);
  EXPECT_FALSE(small_count("256"));
  EXPECT_FALSE(small_count("-1"));
}

TEST(NmeaFields, TimesOfDay) {
  EXPECT_EQ(time_of_day("000000"), Duration{0});
  EXPECT_EQ(time_of_day("235959.999"), 24h - 1ms);
  EXPECT_EQ(time_of_day("132820.60"), 13h + 28min + 20s + 600ms);
  EXPECT_EQ(time_of_day("235960.00"), 24h);
  for (const std::string_view bad : {"", "12", "240000", "126000", "120061", "12-100", "1200:0"})
    EXPECT_FALSE(time_of_day(bad)) << bad;
}

TEST(NmeaFields, Dates) {
  using namespace std::chrono;
  EXPECT_EQ(date_ddmmyy("010626"), sys_days{year{2026} / 6 / 1});
  EXPECT_EQ(date_ddmmyy("290224"), sys_days{year{2024} / 2 / 29});
  EXPECT_EQ(date_ddmmyy("311299"), sys_days{year{1999} / 12 / 31});
  for (const std::string_view bad : {"", "290223", "000126", "010026", "1326", "01062026"})
    EXPECT_FALSE(date_ddmmyy(bad)) << bad;
  EXPECT_EQ(date("01", "06", "2026"), sys_days{year{2026} / 6 / 1});
  EXPECT_FALSE(date("01", "06", "26"));
  EXPECT_FALSE(date("01", "06", "2300"));
}

}  // namespace
}  // namespace slamd::nmea
