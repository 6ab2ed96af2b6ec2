#include "tests/endurance/lap.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "drivers/io/pcap_sink.hpp"
#include "drivers/io/pcap_source.hpp"
#include "firmware/protocol/imu_frame.hpp"
#include "tests/endurance/nmea_clock.hpp"

namespace slamd::endurance {
namespace {

constexpr std::uint16_t kLidarPort = 2368;
constexpr std::size_t kLidarBytes = 1206, kStampAt = 1200;
constexpr std::int64_t kHourUs = 3'600'000'000;
constexpr std::int64_t kPacketNs = 1'327'104;  // 24 firings of 55.296 us
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kRest_s = 20;           // at the start: the lap may begin anywhere in it
constexpr std::int64_t kTailPackets = kNsPerSecond / kPacketNs;  // at the end, left out: other wires end later than the LiDAR's
constexpr std::int64_t kImuPeriodNs = 5'000'000;
/// Half of what lies between two reads of a wire: so long before its end a lap ends, for arrivals jitter.
constexpr std::array<Duration, Lap::kWires.size()> kMargins{Duration{kPacketNs / 2}, Duration{kImuPeriodNs / 2}, std::chrono::milliseconds{500}};

std::int64_t stamp_us(std::span<const std::uint8_t> payload) {
  std::int64_t stamp = 0;
  for (std::size_t i = 4; i-- > 0;) stamp = stamp << 8 | payload[kStampAt + i];
  return stamp;
}

void store_stamp(std::vector<std::uint8_t>& payload, std::int64_t stamp) {
  for (std::size_t i = 0; i < 4; ++i) payload[kStampAt + i] = static_cast<std::uint8_t>(stamp >> (8 * i));
}

bool is_lidar(const UdpPacket& packet) { return packet.destination_port == kLidarPort && packet.payload.size() == kLidarBytes; }

/// How many packets take a whole number of seconds best, of those numbers that leave 0 to kRest_s of `packets` out.
std::int64_t packets_of_a_lap(std::int64_t packets) {
  const std::int64_t whole_s = packets * kPacketNs / kNsPerSecond;
  std::int64_t best = 0;
  double least = std::numeric_limits<double>::max();
  for (std::int64_t seconds = whole_s; seconds > whole_s - kRest_s && seconds > 0; --seconds) {
    const double exact = static_cast<double>(seconds * kNsPerSecond) / static_cast<double>(kPacketNs);
    if (std::abs(exact - std::round(exact)) >= least) continue;
    least = std::abs(exact - std::round(exact));
    best = std::llround(exact);
  }
  return best;
}

void move_lidar(std::vector<std::uint8_t>& payload, std::int64_t by_us) {
  if (payload.size() == kLidarBytes) store_stamp(payload, (stamp_us(payload) + by_us) % kHourUs);
}

/// Damaged frames stay as they are.
void move_imu(std::vector<std::uint8_t>& bytes, std::int64_t by_us, std::int64_t samples) {
  if (bytes.size() != kImuFrameWireBytes) return;
  DecodedImuFrame decoded = decode_imu_packet(std::span{bytes}.first(kImuFramePacketBytes));
  if (!decoded) return;
  decoded.frame.device_us += static_cast<std::uint64_t>(by_us);
  decoded.frame.sequence = static_cast<std::uint16_t>(decoded.frame.sequence + samples);
  const auto moved = encode(decoded.frame);
  bytes.assign(moved.begin(), moved.end());
}

}  // namespace

Result<LapPlan> plan_lap(const std::string& folder) {
  const auto first_and_count = [&](std::int64_t left_out) -> std::optional<std::pair<HostTime, std::int64_t>> {
    Result<PcapSource> opened = PcapSource::open((folder + "/lidar.pcap").c_str());
    if (!opened) return std::nullopt;
    PcapSource capture = std::move(opened).value();
    std::optional<std::int64_t> first_us;
    std::int64_t newest = -1;
    std::optional<HostTime> begin;
    while (const UdpPacket* packet = capture.next()) {
      if (!is_lidar(*packet)) continue;
      if (!first_us) first_us = stamp_us(packet->payload);
      const std::int64_t since_us = (stamp_us(packet->payload) - *first_us + kHourUs) % kHourUs;
      newest = std::llround(static_cast<double>(since_us) * 1e3 / static_cast<double>(kPacketNs));
      if (!begin && newest >= left_out) begin = packet->arrival;
    }
    if (!begin) return std::nullopt;
    return std::pair{*begin, newest + 1};
  };
  const auto all = first_and_count(0);
  const std::int64_t usable = all ? all->second - kTailPackets : 0;
  const std::int64_t packets = packets_of_a_lap(usable);
  if (packets <= 0) return Error{"no lidar.pcap of a lap there"};
  const auto lap = first_and_count(usable - packets);
  return LapPlan{lap->first, std::llround(static_cast<double>(packets * kPacketNs) * 1e-9), Duration{packets * kPacketNs}};
}

Lap::Lap(const std::string& folder, const LapPlan& plan) : plan_{plan} {
  for (std::size_t wire = 0; wire < kWires.size(); ++wire) {
    Result<PcapSource> opened = PcapSource::open((folder + '/' + kWires[wire]).c_str());
    if (!opened) continue;
    PcapSource capture = std::move(opened).value();
    std::vector<Read>& reads = reads_[wire];
    while (const UdpPacket* packet = capture.next()) {
      if (packet->arrival < plan.begin || (wire == 0 && !is_lidar(*packet))) continue;
      if (!reads.empty() && packet->arrival >= reads.front().arrival + plan.period - kMargins[wire]) break;
      reads.push_back({packet->arrival, packet->destination_port, {packet->payload.begin(), packet->payload.end()}});
    }
  }
}

std::vector<std::uint8_t> Lap::moved_on(std::size_t wire, const Read& read, std::int64_t laps) const {
  std::vector<std::uint8_t> bytes = read.bytes;
  const std::int64_t by_ns = laps * plan_.period.count();
  if (wire == 0) move_lidar(bytes, by_ns / 1000 % kHourUs);
  if (wire == 1) move_imu(bytes, by_ns / 1000, laps * ((plan_.period.count() + kImuPeriodNs / 2) / kImuPeriodNs));
  if (wire == 2) move_sentence(bytes, laps * plan_.seconds);
  return bytes;
}

void Lap::write(std::size_t wire, Duration length, const std::string& path) const {
  Result<PcapSink> opened = PcapSink::open(path.c_str());
  if (!opened) return;
  PcapSink sink = std::move(opened).value();
  for (std::int64_t laps = 0; !reads_[wire].empty() && laps * plan_.period < length; ++laps) {
    for (const Read& read : reads_[wire]) {
      const std::vector<std::uint8_t> bytes = moved_on(wire, read, laps);
      sink.write({bytes, read.arrival + laps * plan_.period, {}, read.port, read.port});
    }
  }
}

}  // namespace slamd::endurance
