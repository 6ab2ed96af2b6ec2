// Logs of real receivers against what gpsd made of them (shared/data/nmea). Strict: every position that gpsd gives from
// a GGA or RMC must come out of our parser, in order, within 1e-7 degrees, and every fix of ours must be one of gpsd's.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/drivers/nmea_text.hpp"

namespace slamd {
namespace {

namespace fs = std::filesystem;
using test::Fixes;

/// One TPV of gpsd with a position, and the sentence it was made at.
struct Expected {
  double latitude_deg, longitude_deg;
  std::string time;       // ISO 8601, empty when gpsd had none
  double height_m = NAN;  // altHAE
  std::string sentence;   // newest with a position: "GGA", "RMC", "GLL", "GNS", ...
};

/// What of a log differs, and why. The numbers are exact: one more or one less fails. All else must agree in full.
struct Difference {
  int positions = 0;  // of gpsd that are no fix of ours
  int ours = 0;       // fixes of ours that gpsd does not report
  int heights = 0;    // of gpsd where ours is not valid
  double tolerance_deg = 1e-7;
  const char* why = "";
};

constexpr const char* kNoSeparation = "GGA without geoid separation: gpsd adds its own geoid model, we give no height";
constexpr const char* kTwoDimensions = "GSA says 2D: gpsd still reports the height, we do not believe it";
constexpr const char* kGll =
    "positions of GLL or GNS, which we do not read, before or after GGA and RMC of their second";
constexpr const char* kSimulator = "quality 8 (simulator) in GGA while RMC of the same second is void: refused";
constexpr const char* kFewerDigits = "RMC repeats GGA's position with a digit less: the fix carries GGA's";

const std::map<std::string, Difference>& differences() {
  static const std::map<std::string, Difference> kTable{
      {"GPSmap-76S", {.positions = 2, .why = kSimulator}},
      {"garmin-geko201", {.positions = 2, .why = kSimulator}},
      {"ac12_binary", {.heights = 7, .tolerance_deg = 1e-6, .why = kFewerDigits}},
      {"tcp-torture", {.tolerance_deg = 1e-6, .why = kFewerDigits}},
      {"udp-test", {.tolerance_deg = 1e-6, .why = kFewerDigits}},
      {"bundg_zeus_9",
       {.positions = 858,
        .ours = 44,
        .why = "RMC and GLL carry the rounded position of the second before GGA's: the fix carries GGA's"}},
      {"ericsson-gru04", {.positions = 2, .why = kGll}},
      {"garmin38", {.positions = 2, .why = kGll}},
      {"neo-m8n", {.positions = 1, .why = kGll}},
      {"triton400", {.positions = 1, .why = kGll}},
      {"ublox-zed-f9t-ubx_nmea_l5", {.ours = 1, .why = "gpsd reports from the second epoch on"}},
      {"iTrek", {.heights = 32, .why = kNoSeparation}},
      {"eXplorist210", {.heights = 12, .why = kNoSeparation}},
      {"magellan315", {.heights = 9, .why = kNoSeparation}},
      {"quectelLC79D-1", {.heights = 287, .why = kNoSeparation}},
      {"haicom-305N", {.heights = 19, .why = kTwoDimensions}},
      {"mtk-3329", {.heights = 4, .why = kTwoDimensions}},
      {"rgm3800", {.heights = 7, .why = kTwoDimensions}},
      {"sl869", {.heights = 18, .why = kTwoDimensions}},
      {"telit-pls83-w", {.heights = 104, .why = kTwoDimensions}},
      {"tomtom-mkII", {.heights = 6, .why = kTwoDimensions}},
  };
  return kTable;
}

std::string read_file(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// Lines one millisecond apart; a second passes where GGA or RMC tell a new time.
std::vector<GnssFix> our_fixes(std::string log) {
  std::erase(log, '|');  // gpsd's mark of a TCP segment
  NmeaParser::Config config = NmeaParser::Config::defaults();
  config.not_before = GnssTime{};  // the logs are old: no roll-over is made up
  Fixes f{config};
  HostTime arrival{std::chrono::seconds{1000}};
  std::string time;
  for (std::size_t begin = 0; begin < log.size();) {
    const std::size_t end = std::min(log.find('\n', begin), log.size() - 1) + 1;
    const std::string line = log.substr(begin, end - begin);
    begin = end;
    const bool timed =
        line.size() > 14 && line[0] == '$' && (line.substr(3, 4) == "GGA," || line.substr(3, 4) == "RMC,");
    const std::string new_time = timed ? line.substr(7, line.find(',', 7) - 7) : time;
    arrival += std::chrono::milliseconds{new_time == time ? 1 : 1000};
    time = new_time;
    f.feed(line, arrival);
  }
  f.finish();
  return f.fixes;
}

bool has_position(const std::string& type) {
  return type == "GGA" || type == "RMC" || type == "GLL" || type == "GNS" || type == "MF," || type == "HR,";
}

std::vector<Expected> gpsd_positions(const fs::path& path) {
  std::vector<Expected> positions;
  std::ifstream lines{path};
  std::string sentence;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > 6 && line[0] == '$' && has_position(line.substr(3, 3))) sentence = line.substr(3, 3);
    if (line.find("\"TPV\"") == std::string::npos) continue;
    const nlohmann::json tpv = nlohmann::json::parse(line);
    if (!tpv.contains("lat") || !tpv.contains("lon")) continue;
    positions.push_back({tpv["lat"], tpv["lon"], tpv.value("time", ""), tpv.value("altHAE", NAN), sentence});
  }
  return positions;
}

bool same_place(const Expected& e, const GnssFix& fix, double tolerance_deg) {
  return std::abs(e.latitude_deg - fix.latitude_deg) <= tolerance_deg &&
         std::abs(e.longitude_deg - fix.longitude_deg) <= tolerance_deg;
}

std::vector<fs::path> logs() {
  std::vector<fs::path> paths;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator{fs::path{SLAMD_SHARED_DATA} / "nmea", none}) {
    if (entry.path().extension() == ".log") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// gpsd's time without the zone, to nanoseconds since 1970.
std::optional<GnssTime> parse_time(const std::string& iso) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  double second = 0.0;
  if (std::sscanf(iso.c_str(), "%d-%d-%dT%d:%d:%lf", &year, &month, &day, &hour, &minute, &second) != 6)
    return std::nullopt;
  const std::chrono::sys_days date{std::chrono::year{year} / month / day};
  return GnssTime{date.time_since_epoch()} + std::chrono::hours{hour} + std::chrono::minutes{minute} +
         from_seconds(second);
}

/// Made at a sentence that we read.
bool of_ours(const Expected& e) {
  return e.sentence == "GGA" || e.sentence == "RMC";
}

/// Equal but for the roll-overs that gpsd makes up when a log has no date in its head.
bool same_time(const Expected& e, const GnssFix& fix) {
  const std::optional<GnssTime> expected = parse_time(e.time);
  if (!expected || !of_ours(e) || !fix.utc_valid) return true;
  const Duration roll_over = std::chrono::weeks{1024};
  const Duration difference = abs(*expected - fix.utc) % roll_over;
  return std::min(difference, roll_over - difference) <= std::chrono::milliseconds{1};
}

struct Comparison {
  int positions = 0, ours = 0, heights = 0;
  int wrong_times = 0, wrong_heights = 0;
};

/// Walks both lists once: what is found lies at or behind what was found before.
Comparison compare(const std::vector<Expected>& expected, const std::vector<GnssFix>& fixes, double tolerance_deg) {
  Comparison c;
  std::vector<bool> known(fixes.size());
  std::size_t cursor = 0;
  for (const Expected& e : expected) {
    bool found = false, time_found = false, height_found = false, without_height = false;
    for (std::size_t i = cursor; i < fixes.size(); ++i) {
      if (!same_place(e, fixes[i], tolerance_deg)) continue;
      if (!found && of_ours(e)) cursor = i;
      found = known[i] = true;
      time_found = time_found || same_time(e, fixes[i]);
      height_found = height_found || (fixes[i].height_valid && std::abs(fixes[i].height_m - e.height_m) < 1e-3);
      without_height = without_height || !fixes[i].height_valid;
    }
    if (!found) {
      ++c.positions;
      continue;
    }
    c.wrong_times += time_found ? 0 : 1;
    if (std::isnan(e.height_m) || height_found) continue;
    ++(without_height ? c.heights : c.wrong_heights);
  }
  // gpsd does not report the epoch that the end of a log cuts off
  for (std::size_t i = 0; i + 1 < known.size(); ++i) c.ours += known[i] ? 0 : 1;
  return c;
}

class NmeaGpsd : public testing::TestWithParam<fs::path> {};

TEST_P(NmeaGpsd, GivesTheSameFixes) {
  const std::string name = GetParam().stem();
  const auto entry = differences().find(name);
  const Difference difference = entry == differences().end() ? Difference{} : entry->second;
  const auto fixes = our_fixes(read_file(GetParam()));
  const auto expected = gpsd_positions(GetParam().string() + ".chk");
  const Comparison c = compare(expected, fixes, difference.tolerance_deg);
  EXPECT_EQ(c.positions, difference.positions) << difference.why;
  EXPECT_EQ(c.ours, difference.ours) << difference.why;
  EXPECT_EQ(c.heights, difference.heights) << difference.why;
  EXPECT_EQ(c.wrong_heights, 0);
  EXPECT_EQ(c.wrong_times, 0);
}

INSTANTIATE_TEST_SUITE_P(Logs, NmeaGpsd, testing::ValuesIn(logs()), [](const auto& tested) {
  std::string name = tested.param.stem();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(NmeaGpsd);

TEST(NmeaGpsdLogs, AreAllThere) {
  if (logs().empty()) GTEST_SKIP() << "shared data is not here";
  EXPECT_EQ(logs().size(), 59U);
}

}  // namespace
}  // namespace slamd
