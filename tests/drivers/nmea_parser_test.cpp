#include "drivers/gnss/nmea_parser.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "tests/drivers/nmea_text.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;
using test::Fixes;
using test::sentence;

std::string clock_text(int second_of_day) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%02d%02d%02d.00", second_of_day / 3600 % 24, second_of_day / 60 % 60,
                second_of_day % 60);
  return text.data();
}
std::string gga(int second, const char* minutes = "15.91801", const char* tail = "1,11,0.87,481.6,M,46.2,M,,") {
  return sentence("GPGGA," + clock_text(second) + ",48" + minutes + ",N,01140.28435,E," + tail);
}
std::string rmc(int second, const char* date = "010626", const char* minutes = "15.91801",
                const char* motion = "10.0,90.0") {
  return sentence("GPRMC," + clock_text(second) + ",A,48" + minutes + ",N,01140.28435,E," + motion + "," + date +
                  ",,,A");
}
std::string gst(int second, const char* sigmas = "1.2,1.6,3.0") {
  return sentence("GPGST," + clock_text(second) + ",5.4,1.1,1.1,45.0," + sigmas);
}
const std::string kGsa3d = sentence("GPGSA,A,3,02,04,05,,,,,,,,,,1.57,0.87,1.31");
const std::string kGsa2d = sentence("GPGSA,A,2,02,04,05,,,,,,,,,,1.57,0.87,1.31");
const std::string kVtg = sentence("GPVTG,45.0,T,,M,3.6,N,,K,A");

HostTime at(int second, Duration late = 120ms) {
  return HostTime{std::chrono::seconds{5000 + second}} + late;
}

TEST(NmeaParser, MakesOneFixOfAllSentencesOfAnEpoch) {
  Fixes f;
  f.feed(gga(36000) + rmc(36000) + kGsa3d + gst(36000), at(0));
  f.finish();
  ASSERT_EQ(f.fixes.size(), 1U);
  const GnssFix& fix = f.fixes[0];
  EXPECT_NEAR(fix.latitude_deg, 48.0 + 15.91801 / 60, 1e-12);
  EXPECT_NEAR(fix.longitude_deg, 11.0 + 40.28435 / 60, 1e-12);
  EXPECT_TRUE(fix.height_valid);
  EXPECT_NEAR(fix.height_m, 481.6 + 46.2, 1e-9);
  EXPECT_EQ(fix.quality, GnssQuality::kAutonomous);
  EXPECT_EQ(fix.satellites, 11);
  EXPECT_TRUE(fix.velocity_valid);
  EXPECT_NEAR(fix.speed_mps, 5.14444, 1e-4);
  EXPECT_NEAR(fix.course_deg, 90.0, 1e-12);
  EXPECT_NEAR(fix.sigma_horizontal_m, std::sqrt((1.44 + 2.56) / 2), 1e-9);
  EXPECT_NEAR(fix.sigma_vertical_m, 3.0, 1e-9);
  ASSERT_TRUE(fix.utc_valid);
  EXPECT_EQ(fix.utc.time_since_epoch(),
            std::chrono::sys_days{std::chrono::year{2026} / 6 / 1}.time_since_epoch() + 10h);
  EXPECT_FALSE(fix.stale);
}

TEST(NmeaParser, ByteAtATimeEqualsAllAtOnce) {
  std::string all;
  for (int s = 0; s < 30; ++s) all += gga(s) + kGsa3d + rmc(s) + kVtg;
  Fixes whole, bytewise;
  whole.feed(all, at(0));
  for (const char c : all) bytewise.feed({&c, 1}, at(0));
  ASSERT_EQ(whole.fixes.size(), bytewise.fixes.size());
  ASSERT_GE(whole.fixes.size(), 29U);
  for (std::size_t i = 0; i < whole.fixes.size(); ++i) {
    EXPECT_EQ(whole.fixes[i].utc, bytewise.fixes[i].utc);
    EXPECT_EQ(whole.fixes[i].time, bytewise.fixes[i].time);
  }
}

/// Once the order is known a fix comes with the last sentence of its own second, whatever the order is.
TEST(NmeaParser, DoesNotWaitForTheNextSecondOnceItKnowsTheOrder) {
  const auto cycles = std::vector<std::vector<std::string>>{
      {"gga", "gsa", "rmc", "vtg"}, {"rmc", "gga"}, {"gsa", "gsa", "rmc", "gga", "gst"}, {"rmc"}, {"gga"},
      {"vtg", "gsa", "gga"}};
  for (const auto& cycle : cycles) {
    Fixes f;
    for (int s = 0; s < 20; ++s) {
      for (std::size_t i = 0; i < cycle.size(); ++i) {
        const std::string& type = cycle[i];
        f.feed(type == "gga"   ? gga(s)
               : type == "rmc" ? rmc(s)
               : type == "gst" ? gst(s)
               : type == "gsa" ? kGsa3d
                               : kVtg,
               at(s, 120ms + static_cast<int>(i) * 5ms));
      }
      if (s >= 4) {
        ASSERT_EQ(f.fixes.size(), static_cast<std::size_t>(s) + 1) << cycle.front() << ' ' << s;
        EXPECT_EQ(f.fixes.back().arrival, at(s, 120ms + static_cast<int>(cycle.size() - 1) * 5ms));
      }
    }
  }
}

TEST(NmeaParser, SentencesSentRarelyDelayNothing) {
  Fixes f;
  for (int s = 0; s < 40; ++s) {
    f.feed(gga(s) + (s % 5 == 0 ? kGsa2d : "") + rmc(s) + (s % 7 == 0 ? gst(s) : ""), at(s));
    if (s >= 16) {
      EXPECT_EQ(f.fixes.size(), static_cast<std::size_t>(s) + 1);
      EXPECT_FALSE(f.fixes.back().height_valid);  // the dimension of the last GSA holds
    }
  }
}

TEST(NmeaParser, AReceiverThatStopsSendingASentenceDelaysOneFixOnly) {
  Fixes f;
  for (int s = 0; s < 20; ++s) f.feed(gga(s) + rmc(s) + (s < 10 ? kVtg : ""), at(s));
  EXPECT_EQ(f.fixes.size(), 20U);
}

TEST(NmeaParser, HostTimeComesFromUtcNotFromTheJitterOfArrival) {
  Fixes f;
  std::mt19937 random{3};
  std::uniform_real_distribution<double> late{0.0, 0.02};
  for (int s = 0; s < 120; ++s) f.feed(gga(s) + rmc(s), at(s, 120ms + from_seconds(late(random))));
  for (const GnssFix& fix : f.fixes)
    EXPECT_NEAR(to_seconds(fix.time - at(0, 0ms)), std::round(to_seconds(fix.time - at(0, 0ms))), 0.015);
  EXPECT_NEAR(to_seconds(f.fixes.back().time - at(119, 0ms)), 0.0, 0.004);
}

TEST(NmeaParser, GoesOverMidnightWithAndWithoutDates) {
  for (const bool dated : {true, false}) {
    Fixes f;
    f.feed(gga(86395) + rmc(86395, "311226"), at(0));
    for (int i = 1; i < 12; ++i) {
      const int second = (86395 + i) % 86400;
      f.feed(gga(second) + (dated ? rmc(second, i < 5 ? "311226" : "010127") : ""), at(i));
    }
    f.finish();
    ASSERT_EQ(f.fixes.size(), 12U);
    for (std::size_t i = 1; i < f.fixes.size(); ++i) {
      EXPECT_EQ(f.fixes[i].utc - f.fixes[i - 1].utc, 1s) << dated << ' ' << i;
      EXPECT_NEAR(to_seconds(f.fixes[i].time - f.fixes[i - 1].time), 1.0, 1e-2);
    }
    EXPECT_EQ(f.parser.clock().jumps(), 0U);
  }
}

TEST(NmeaParser, ADateThatChangesASecondLateIsCorrected) {
  Fixes f;
  for (int i = 0; i < 10; ++i) {
    const int second = (86395 + i) % 86400;
    f.feed(gga(second) + rmc(second, i < 7 ? "311226" : "010127"), at(i));
  }
  f.finish();
  for (std::size_t i = 1; i < f.fixes.size(); ++i) EXPECT_EQ(f.fixes[i].utc - f.fixes[i - 1].utc, 1s);
}

TEST(NmeaParser, DatesOfAReceiverThatMissedARollOverAreMovedOn) {
  Fixes f;
  f.feed(rmc(36000, "161006"), at(0));  // 1,024 weeks before 2026-06-01
  f.finish();
  ASSERT_EQ(f.fixes.size(), 1U);
  EXPECT_EQ(std::chrono::floor<std::chrono::days>(f.fixes[0].utc.time_since_epoch()),
            std::chrono::sys_days{std::chrono::year{2026} / 6 / 1}.time_since_epoch());
}

TEST(NmeaParser, ARepeatedSecondGivesNoSecondFix) {
  Fixes f;
  for (int s = 0; s < 6; ++s) f.feed(gga(s) + rmc(s), at(s));
  for (int s = 6; s < 10; ++s) f.feed(gga(5) + rmc(5), at(s));
  EXPECT_EQ(f.fixes.size(), 6U);
  EXPECT_EQ(f.parser.epochs().repeated(), 4U);
  f.feed(gga(10) + rmc(10), at(10));
  f.finish();
  EXPECT_EQ(f.fixes.size(), 7U);
}

TEST(NmeaParser, APositionThatStaysWhileTheVehicleMovesIsStale) {
  Fixes f;
  for (int s = 0; s < 5; ++s) f.feed(gga(s) + rmc(s), at(s));
  f.feed(gga(5, "15.92000") + rmc(5, "010626", "15.92000"), at(5));
  f.finish();
  ASSERT_EQ(f.fixes.size(), 6U);
  EXPECT_FALSE(f.fixes[0].stale);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_TRUE(f.fixes[i].stale) << i;
  EXPECT_FALSE(f.fixes[5].stale);
}

TEST(NmeaParser, APositionThatStaysAtRestIsGood) {
  Fixes f;
  for (int s = 0; s < 30; ++s) f.feed(gga(s) + rmc(s, "010626", "15.91801", "0.1,90.0"), at(s));
  f.finish();
  EXPECT_EQ(f.parser.stats().stale, 0U);
  EXPECT_EQ(f.fixes.size(), 30U);
}

TEST(NmeaParser, WithoutSpeedAFrozenPositionIsStaleAfterAWhile) {
  Fixes f;
  for (int s = 0; s < 30; ++s) f.feed(gga(s), at(s));
  EXPECT_FALSE(f.fixes[5].stale);
  EXPECT_TRUE(f.fixes.back().stale);
}

TEST(NmeaParser, NoFixWhereTheReceiverSaysSo) {
  Fixes f;
  for (int s = 0; s < 5; ++s) f.feed(gga(s, "15.91801", "0,00,99.99,,M,,M,,"), at(s));
  f.feed(sentence("GPRMC,000010.00,V,4815.91801,N,01140.28435,E,,,010626,,,N"), at(10));
  f.feed(sentence("GPGGA,,,,,,0,,,,,,,,") + sentence("GPRMC,,V,,,,,,,,,,N"), at(11));
  f.finish();
  EXPECT_TRUE(f.fixes.empty());
  EXPECT_EQ(f.parser.stats().epochs_without_fix, 6U);
}

TEST(NmeaParser, AModeOfNoneIsNoFixWhateverTheStatusSays) {
  Fixes f;
  f.feed(sentence("GPRMC,000010.00,A,4815.91801,N,01140.28435,E,,,010626,,,N"), at(10));
  f.finish();
  EXPECT_TRUE(f.fixes.empty());
}

TEST(NmeaParser, ASentenceOfThePastSecondIsIgnored) {
  Fixes f;
  for (int s = 0; s < 5; ++s) f.feed(gga(s), at(s));
  f.feed(gst(3), at(4, 200ms));
  f.feed(gga(5), at(5));
  EXPECT_EQ(f.parser.epochs().late(), 1U);
  EXPECT_EQ(f.fixes.size(), 6U);
}

TEST(NmeaParser, OfSeveralTalkersTheOneWithMostSatellitesCounts) {
  Fixes f;
  f.feed(gga(0, "15.91801", "1,05,1.3,481.6,M,46.2,M,,") + gga(0, "15.91801", "1,12,1.3,481.6,M,46.2,M,,") +
             gga(0, "15.91801", "1,01,1.3,481.6,M,46.2,M,,"),
         at(0));
  f.finish();
  ASSERT_EQ(f.fixes.size(), 1U);
  EXPECT_EQ(f.fixes[0].satellites, 12);
}

/// The sample drive's receiver sends some 120 ms after the second; host time is UTC there.
TEST(NmeaParser, StampsTheFixesOfTheSampleDriveWithTheirOwnSecond) {
  std::ifstream file{std::string{SLAMD_SHARED_DATA} + "/drive_sample/gps.csv"};
  if (!file) GTEST_SKIP() << "shared data is not here";
  Fixes f;
  for (std::string line; std::getline(file, line);) {
    const std::size_t comma = line.find(',');
    if (line.starts_with("t_ns")) continue;
    f.feed(line.substr(comma + 1) + "\r\n", from_ns<HostTime>(std::stoll(line)));
  }
  f.finish();
  EXPECT_EQ(f.fixes.size(), 24U);
  for (const GnssFix& fix : f.fixes) {
    EXPECT_NEAR(to_seconds(fix.time.time_since_epoch() - fix.utc.time_since_epoch()), 0.0, 0.005);
    EXPECT_GE(fix.sigma_horizontal_m, 1.0);
    EXPECT_TRUE(fix.height_valid);
  }
}

TEST(NmeaParser, VelocityOfVtgWhereRmcIsNotSent) {
  Fixes f;
  for (int s = 0; s < 5; ++s) f.feed(kVtg + gga(s), at(s));
  ASSERT_GE(f.fixes.size(), 4U);
  EXPECT_TRUE(f.fixes.back().velocity_valid);
  EXPECT_NEAR(f.fixes.back().speed_mps, 1.852, 1e-9);
  EXPECT_NEAR(f.fixes.back().course_deg, 45.0, 1e-12);
}

}  // namespace
}  // namespace slamd
