// Payloads of the three ports of an Airy, of any content. Every data packet is accepted or counted; a point is found again in the
// bytes; device packets that are taken have angles within 90 degrees; IMU samples are finite and in order.

#include <cmath>
#include <cstdlib>
#include <vector>

#include "drivers/io/byte_reader.hpp"
#include "drivers/robosense/airy_decoder.hpp"
#include "drivers/robosense/airy_imu_parser.hpp"

namespace {

using namespace slamd;

void require(bool holds) {
  if (!holds) std::abort();
}

/// True when the column that fired at the point's time holds its distance and intensity.
bool is_in_bytes(const LidarPoint& point, const AiryPacket& packet) {
  const auto column = static_cast<std::size_t>(point.time_offset_ns / 111'080);
  const double range_m = std::hypot(point.x, point.y, point.z);
  for (std::size_t channel = 0; channel < kAiryChannels; ++channel) {
    for (std::size_t which = 0; which < (packet.returns == AiryReturns::kDual ? 2 : 1); ++which) {
      const AiryReturn found = packet.at(column, channel, which);
      if (found.intensity == point.intensity && std::abs(found.distance_5mm * 0.005 - range_m) < 0.08) return true;
    }
  }
  return false;
}

void check(const LidarPacket& out, const AiryPacket& packet) {
  require(out.point_count <= LidarPacket::kMaxPoints);
  require(out.azimuth_begin_cdeg < 36000 && out.azimuth_end_cdeg < 36000);
  std::int32_t previous_ns = 0;
  for (std::size_t i = 0; i < out.point_count; ++i) {
    const LidarPoint& point = out.points[i];
    require(point.time_offset_ns >= previous_ns && Duration{point.time_offset_ns} < out.span);
    require(point.azimuth_cdeg < 36000 && point.ring < kAiryChannels && point.return_index < 2);
    require(is_in_bytes(point, packet));
    previous_ns = point.time_offset_ns;
  }
}

void store(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (count - 1 - i)));
}

/// Makes the parts good that random bytes never hit, so that the rest is reached.
void repair(std::vector<std::uint8_t>& payload, std::uint8_t control) {
  payload.resize(kAiryPacketBytes);
  store(payload, 0, 0x55AA055A, 4);
  payload[16] = 0;
  payload[32] = 2;
  store(payload, 20, 0, 5);
  store(payload, 26, (payload[26] * 3'900U) % 1'000'000U, 4);
  const std::size_t stride = payload[17] == 3 ? 4 : 2;
  for (std::size_t block = 0; block < kAiryBlocks; ++block) {
    const std::size_t at = kAiryHeaderBytes + block * kAiryBlockBytes;
    store(payload, at, 0xFFEE, 2);
    if ((control & 2U) != 0) store(payload, at + 2, (payload[40] * 137U + (30U + control / 8U) * (block / stride)) % 36000, 2);
  }
}

void repair_device(std::vector<std::uint8_t>& payload) {
  payload.resize(kAiryDeviceBytes);
  store(payload, 0, 0xA5FF005A11115555, 8);
  store(payload, kAiryDeviceBytes - 2, 0x0FF0, 2);
  for (std::size_t i = 0; i < 192; ++i) {
    payload[468 + 3 * i] &= 1U;
    payload[469 + 3 * i] &= 0x1FU;
  }
}

void repair_imu(std::vector<std::uint8_t>& payload) {
  payload.resize(51);
  store(payload, 0, 0xAA555A05, 4);
  store(payload, 4, 0, 6);
  store(payload, 10, payload[12] * 3'000U, 4);
  for (std::size_t i = 0; i < 6; ++i) store(payload, 14 + 4 * i, payload[15 + 4 * i] < 128 ? 0 : 0xFFFF, 2);
  payload[43] &= 3U;
  payload[44] &= 3U;
}

void check_device(const AiryDecoder& decoder) {
  for (const std::int16_t angle : decoder.device()->elevation_cdeg) require(std::abs(angle) <= 9000);
  require(std::abs(decoder.device()->R_lidar_imu.norm() - 1.0) < 1e-6);
}

}  // namespace

/// Records of: control byte (bit 0: repair, bit 1: azimuths too, bits 2 and 3: port), arrival step in us (4 bytes), then a payload of up
/// to 1248 bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  AiryDecoder decoder{{}};
  AiryImuParser imu;
  ByteReader reader{{bytes, size}};
  HostTime arrival{std::chrono::seconds{10}};
  while (reader.remaining() > 5) {
    const std::uint8_t control = reader.u8();
    arrival += std::chrono::microseconds{reader.u32_le()};
    const auto body = reader.take(std::min(reader.remaining(), kAiryPacketBytes));
    std::vector<std::uint8_t> payload{body.begin(), body.end()};
    const unsigned port = (control >> 2U) & 3U;
    if ((control & 1U) != 0) port == 1 ? repair_device(payload) : port == 2 ? repair_imu(payload) : repair(payload, control);
    if (port == 1) {
      if (decoder.inform(payload)) check_device(decoder);
    } else if (port == 2) {
      imu.feed(payload, arrival, [&](const ImuSample& sample) {
        require(sample.gyro_rads.allFinite() && sample.accel_mps2.allFinite() && sample.arrival == arrival);
      });
    } else if (const LidarPacket* out = decoder.decode(payload, arrival)) {
      const AiryParsed parsed = parse_airy(payload);
      require(parsed.cause == LidarRejection::kCount && out->arrival == arrival);
      check(*out, parsed.packet);
    }
  }
  require(decoder.stats().received == decoder.stats().accepted + decoder.stats().rejections.total());
  return 0;
}
