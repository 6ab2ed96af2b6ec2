// A dual-return recording against the points that another decoder (Nebula) made of it.
//
// The golden file's conventions: x and y as ours (x = azimuth 0, azimuth clockwise); its `elevation` holds the sine; z
// is without the manual's vertical offset of each laser; `time_stamp` is nanoseconds after the packet's stamp, in steps
// of 238 ns (it went through seconds in a double), and it lets the two blocks of a pair follow each other although they
// are the same firings: block b counts as b * 110.592 us, ours as (b / 2) * 110.592 us. It interpolates azimuths only
// in the first block of each pair but the last: the second has the next pair's azimuth for all its firings, and the
// last pair its own, where ours follow the head (0.398 degrees a block in this recording).
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/io/byte_reader.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"

namespace slamd {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const std::string kFolder = std::string{SLAMD_SHARED_DATA} + "/vlp16/nebula";
const std::string kBag = kFolder + "/1673400471837873222/1673400471837873222_0.db3";
const std::string kCloud = kFolder + "/1673400472138016708.pcd";

struct Recorded {
  HostTime stamp;
  std::vector<std::uint8_t> payload;
};

/// velodyne_msgs/VelodyneScan in CDR: 4 bytes encapsulation, header (stamp, frame_id), sequence of (stamp, 1206 bytes).
/// Alignment counts from the end of the encapsulation.
void read_scan(std::span<const std::uint8_t> cdr, std::vector<Recorded>& packets) {
  ByteReader reader{cdr};
  const auto align = [&reader] { reader.skip((4 - (reader.position() - 4) % 4) % 4); };
  reader.skip(12);
  reader.skip(reader.u32_le());
  align();
  const std::uint32_t count = reader.u32_le();
  for (std::uint32_t i = 0; i < count && reader.ok(); ++i) {
    align();
    const std::int64_t seconds = reader.u32_le();
    const auto stamp = from_ns<HostTime>(seconds * 1'000'000'000 + reader.u32_le());
    const auto payload = reader.take(kVlp16PacketBytes);
    packets.push_back({stamp, {payload.begin(), payload.end()}});
  }
  ASSERT_TRUE(reader.ok());
}

std::vector<Recorded> read_bag() {
  std::vector<Recorded> packets;
  sqlite3* opened = nullptr;
  const std::string uri = "file:" + kBag + "?immutable=1";
  EXPECT_EQ(sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr), SQLITE_OK);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> bag{opened, sqlite3_close};
  sqlite3_stmt* prepared = nullptr;
  EXPECT_EQ(sqlite3_prepare_v2(bag.get(), "select data from messages order by id", -1, &prepared, nullptr), SQLITE_OK);
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows{prepared, sqlite3_finalize};
  while (sqlite3_step(rows.get()) == SQLITE_ROW) {
    const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(rows.get(), 0));
    read_scan({bytes, static_cast<std::size_t>(sqlite3_column_bytes(rows.get(), 0))}, packets);
  }
  return packets;
}

struct Golden {
  float x, y, z;
  std::uint8_t intensity, return_type;
  std::uint16_t channel;
  float azimuth_rad, sin_elevation, distance_m;
  std::uint32_t time_ns;
};
static_assert(sizeof(Golden) == 32);

std::vector<Golden> read_cloud() {
  std::ifstream file{kCloud, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  const std::string mark = "DATA binary\n";
  const std::size_t begin = text.find(mark) + mark.size();
  std::vector<Golden> points((text.size() - begin) / sizeof(Golden));
  std::memcpy(points.data(), text.data() + begin, points.size() * sizeof(Golden));
  return points;
}

/// Ring, distance in millimetres, intensity: what must be equal exactly, and finds a golden point's candidates fast.
using Key = std::tuple<int, int, int>;

double range_of(const LidarPoint& p, double height_m) {
  return std::hypot(p.x, p.y, p.z - height_m);
}

/// The manual's vertical offset by ring.
double height_m(int ring) {
  constexpr double kMm[16] = {11.2, 9.7, 8.1, 6.6, 5.1, 3.7, 2.2, 0.7, -0.7, -2.2, -3.7, -5.1, -6.6, -8.1, -9.7, -11.2};
  return kMm[ring] * 1e-3;
}

class Vlp16Golden : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kBag) || !std::filesystem::exists(kCloud))
      GTEST_SKIP() << "no recording in " << kFolder;
    packets_ = read_bag();
    golden_ = read_cloud();
    ASSERT_EQ(packets_.size(), 603U);
    ASSERT_EQ(golden_.size(), 14831U);
  }

  /// Points of the revolution that the golden cloud shows: it begins when the third message's last packets cross
  /// azimuth 0 and ends in the fourth message. All four messages go through the decoder.
  std::multimap<Key, LidarPoint> decode_golden_revolution() {
    constexpr std::size_t kFirst = 453 - 2;  // packet index
    std::multimap<Key, LidarPoint> found;
    Vlp16Decoder decoder{{}};
    for (std::size_t i = 0; i < packets_.size(); ++i) {
      const LidarPacket* packet = decoder.decode(packets_[i].payload, packets_[i].stamp);
      EXPECT_NE(packet, nullptr) << explain(decoder.last_rejection());
      if (packet == nullptr || i < kFirst) continue;
      for (std::size_t k = 0; k < packet->point_count; ++k) {
        const LidarPoint& p = packet->points[k];
        found.emplace(Key{p.ring, static_cast<int>(std::lround(range_of(p, height_m(p.ring)) * 1000.0)), p.intensity},
                      p);
      }
    }
    EXPECT_EQ(decoder.stats().lost, 0U);
    return found;
  }

  std::vector<Recorded> packets_;
  std::vector<Golden> golden_;
};

constexpr double kBlockNs = 110'592.0;

int golden_block(const Golden& g) {
  return static_cast<int>((g.time_ns + 240.0) / kBlockNs);
}

/// What the golden time stamp says in our counting of dual-return blocks.
double our_time_ns(const Golden& g) {
  return g.time_ns - (golden_block(g) - golden_block(g) / 2) * kBlockNs;
}

/// How far the head stands from the golden azimuth (see above), positive = further turned.
double golden_lag_rad(const Golden& g) {
  constexpr double kStepRad = 0.3982 * kRadPerDeg;
  const double share = our_time_ns(g) / kBlockNs - golden_block(g) / 2;
  if (golden_block(g) >= 10) return share * kStepRad;
  return golden_block(g) % 2 == 1 ? (share - 1.0) * kStepRad : 0.0;
}

struct Difference {
  double azimuth_deg, time_ns, level_m, z_m;
};

Difference difference(const LidarPoint& p, const Golden& g) {
  const double turn = golden_lag_rad(g);
  const double x = g.x * std::cos(turn) + g.y * std::sin(turn);  // clockwise
  const double y = g.y * std::cos(turn) - g.x * std::sin(turn);
  const double azimuth_deg = std::remainder(p.azimuth_cdeg * 0.01 - (g.azimuth_rad + turn) / kRadPerDeg, 360.0);
  return {std::abs(azimuth_deg), std::abs(p.time_offset_ns - our_time_ns(g)), std::hypot(p.x - x, p.y - y),
          std::abs(p.z - height_m(p.ring) - g.z)};
}

/// Azimuths are counted in 0.01 degrees and the golden ones are cut, not rounded; 0.03 degrees at 14.6 m are 8 mm.
bool agree(const Difference& d) {
  return d.azimuth_deg < 0.035 && d.time_ns < 250.0 && d.level_m < 0.008 && d.z_m < 1e-4;
}

TEST_F(Vlp16Golden, EveryGoldenPointIsAmongOurs) {
  const auto ours = decode_golden_revolution();
  std::size_t missing = 0;
  double sum_level_m = 0.0;
  for (const Golden& g : golden_) {
    EXPECT_NEAR(g.sin_elevation, std::sin((g.channel * 2.0 - 15.0) * kRadPerDeg), 1e-6);
    const int millimetres = static_cast<int>(std::lround(g.distance_m * 1000.0F));
    const auto [begin, end] = ours.equal_range({g.channel, millimetres, g.intensity});
    const auto match = std::find_if(begin, end, [&g](const auto& entry) { return agree(difference(entry.second, g)); });
    if (match == end) {
      ++missing;
    } else {
      sum_level_m += difference(match->second, g).level_m;
    }
  }
  EXPECT_EQ(missing, 0U);
  EXPECT_LT(sum_level_m / static_cast<double>(golden_.size()), 0.001);
  // The golden decoder drops the second of two returns within 0.1 m; ours also holds the packets around the revolution.
  EXPECT_NEAR(static_cast<double>(ours.size()), static_cast<double>(golden_.size()), 300.0);
}

}  // namespace
}  // namespace slamd
