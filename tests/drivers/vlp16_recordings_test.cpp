// The decoder against recordings of real sensors and of an independent simulator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/io/pcap_source.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"

namespace slamd {
namespace {

const std::string kShared = SLAMD_SHARED_DATA;

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no recording at " << (path)

std::uint16_t distance_at(std::span<const std::uint8_t> payload, std::size_t i) {
  const std::size_t at = i / 32 * 100 + 4 + i % 32 * 3;
  return static_cast<std::uint16_t>(payload[at] | (payload[at + 1] << 8));
}

/// Returns of a single-return packet within the default limits (0.5 m, 130 m), counted from the bytes.
std::size_t count_returns(std::span<const std::uint8_t> payload) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 384; ++i) count += distance_at(payload, i) >= 250 && distance_at(payload, i) <= 65000;
  return count;
}

TEST(Vlp16Recordings, EinrideDecodesWholly) {
  const std::string path = kShared + "/vlp16/einride/recording.bin";
  SKIP_WITHOUT(path);
  std::ifstream file{path, std::ios::binary};
  const std::vector<char> text{std::istreambuf_iterator<char>{file}, {}};
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  ASSERT_EQ(bytes.size(), 1000 * kVlp16PacketBytes);

  Vlp16Decoder decoder{{}};
  HostTime previous{};
  std::uint16_t azimuth = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto payload = bytes.subspan(i * kVlp16PacketBytes, kVlp16PacketBytes);
    const auto arrival = from_ns<HostTime>(1'000'000'000 + static_cast<std::int64_t>(i) * 1'327'104);
    const LidarPacket* packet = decoder.decode(payload, arrival);
    ASSERT_NE(packet, nullptr) << explain(decoder.last_rejection());
    EXPECT_EQ(packet->point_count, count_returns(payload));
    if (i > 0) {
      EXPECT_NEAR(to_seconds(packet->time - previous), 1327.104e-6,
                  i < 500 ? 200e-6 : 3e-6);  // the clock settles first
      EXPECT_NEAR(azimuth_difference_cdeg(packet->azimuth_begin_cdeg, azimuth), 40.0 * 18.432 / 110.592, 4.0);
    }
    previous = packet->time;
    azimuth = packet->azimuth_end_cdeg;
  }
  EXPECT_EQ(decoder.stats().lost, 0U);
  EXPECT_NEAR(decoder.rotation_rpm(), 600.0, 6.0);
}

TEST(Vlp16Recordings, MrptGivesDataAndPositionPackets) {
  const std::string path = kShared + "/vlp16/mrpt/sample_velodyne_vlp16_gps.pcap";
  SKIP_WITHOUT(path);
  auto source = PcapSource::open(path.c_str());
  ASSERT_TRUE(source) << source.reason();
  PcapSource pcap = std::move(source).value();
  Vlp16Decoder decoder{{}};
  std::size_t positions = 0;
  while (const UdpPacket* udp = pcap.next()) {
    if (udp->destination_port == 2368) {
      EXPECT_NE(decoder.decode(udp->payload, udp->arrival), nullptr) << explain(decoder.last_rejection());
      continue;
    }
    ASSERT_EQ(udp->destination_port, 8308);
    const auto position = parse_vlp16_position(udp->payload);
    ASSERT_TRUE(position) << position.reason();
    EXPECT_EQ(position->pps, PpsState::kLocked);
    EXPECT_EQ(position->nmea, "$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2E");
    ++positions;
  }
  EXPECT_EQ(decoder.stats().accepted, 293U);
  EXPECT_EQ(decoder.stats().lost, 0U);
  EXPECT_EQ(positions, 57U);
  EXPECT_FALSE(pcap.stats().damaged);
  EXPECT_EQ(pcap.bytes_read(), std::filesystem::file_size(path));
}

TEST(Vlp16Recordings, AnHdl32IsRefusedByName) {
  const std::string path = kShared + "/vlp16/mrpt/sample_velodyne_hdl32.pcap";
  SKIP_WITHOUT(path);
  auto source = PcapSource::open(path.c_str());
  ASSERT_TRUE(source) << source.reason();
  PcapSource pcap = std::move(source).value();
  Vlp16Decoder decoder{{}};
  while (const UdpPacket* udp = pcap.next()) EXPECT_EQ(decoder.decode(udp->payload, udp->arrival), nullptr);
  EXPECT_EQ(decoder.stats().received, 500U);
  EXPECT_EQ(decoder.stats().rejections[LidarRejection::kHdl32e], 500U);
  EXPECT_NE(std::string{explain(decoder.last_rejection())}.find("HDL-32E"), std::string::npos);
}

/// The vehicle of the sample drive stands at the start with free, level ground ahead: through T_base_lidar (11 degrees
/// down, 1.86 m up) the lowest beams of the front quarter lie on it. Wrong axes, elevations or azimuths would lift or
/// sink them.
double median_ground_height(const std::vector<LidarPoint>& points) {
  const double pitch = 11.0 * 3.14159265358979 / 180.0;
  std::vector<double> heights;
  for (const LidarPoint& p : points) {
    if (p.ring > 3 || p.x < std::abs(p.y)) continue;
    heights.push_back(1.86 - std::sin(pitch) * p.x + std::cos(pitch) * p.z);
  }
  if (heights.size() < 100) return std::nan("");
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
  return heights[heights.size() / 2];
}

TEST(Vlp16Recordings, TheSampleDriveIsCompleteOrderedAndLevel) {
  const std::string path = kShared + "/drive_sample/lidar.pcap";
  SKIP_WITHOUT(path);
  auto source = PcapSource::open(path.c_str());
  ASSERT_TRUE(source) << source.reason();
  PcapSource pcap = std::move(source).value();
  Vlp16Decoder decoder{{}};
  std::vector<LidarPoint> first_scan;
  HostTime previous{HostTime::min()};
  std::uint64_t positions = 0;
  while (const UdpPacket* udp = pcap.next()) {
    if (udp->destination_port == 8308) {
      positions += parse_vlp16_position(udp->payload) ? 1 : 0;
      continue;
    }
    const LidarPacket* packet = decoder.decode(udp->payload, udp->arrival);
    ASSERT_NE(packet, nullptr) << explain(decoder.last_rejection());
    EXPECT_GT(packet->time, previous);
    EXPECT_LE(packet->time + packet->span, packet->arrival);
    previous = packet->time;
    if (decoder.stats().accepted > 76) continue;
    first_scan.insert(first_scan.end(), packet->points.begin(), packet->points.begin() + packet->point_count);
  }
  EXPECT_EQ(decoder.stats().accepted, 18084U);
  EXPECT_EQ(decoder.stats().lost, 0U);
  EXPECT_EQ(positions, 1291U);
  EXPECT_NEAR(median_ground_height(first_scan), 0.0, 0.1);
}

}  // namespace
}  // namespace slamd
