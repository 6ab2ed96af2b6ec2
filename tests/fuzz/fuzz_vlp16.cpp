// VLP-16 payloads of any content through one decoder. Every point that comes out must be found again in the bytes.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/io/byte_reader.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"

namespace {

using namespace slamd;

void require(bool holds) {
  if (!holds) std::abort();
}

/// True when one of the blocks that fired at the point's time holds its distance and intensity at its laser.
bool is_in_bytes(const LidarPoint& point, const Vlp16Packet& packet) {
  const auto block = static_cast<std::size_t>(point.time_offset_ns / 110'592);
  const int in_block = point.time_offset_ns % 110'592;
  const auto channel = static_cast<std::size_t>(in_block / 55'296 * 16 + in_block % 55'296 / 2'304);
  const bool dual = packet.mode == Vlp16ReturnMode::kDual;
  const double range_m = std::hypot(point.x, point.y, point.z);
  for (std::size_t b = dual ? 2 * block : block; b <= (dual ? 2 * block + 1 : block); ++b) {
    const Vlp16Return found = packet.at(b, channel);
    if (found.intensity == point.intensity && std::abs(found.distance_2mm * 0.002 - range_m) < 0.012) return true;
  }
  return false;
}

void check(const LidarPacket& out, const Vlp16Packet& packet) {
  require(out.point_count <= LidarPacket::kMaxPoints);
  require(out.azimuth_begin_cdeg < 36000 && out.azimuth_end_cdeg < 36000);
  std::int32_t previous_ns = 0;
  for (std::size_t i = 0; i < out.point_count; ++i) {
    const LidarPoint& point = out.points[i];
    require(point.time_offset_ns >= previous_ns && Duration{point.time_offset_ns} < out.span);
    require(point.azimuth_cdeg < 36000 && point.ring < 16 && point.return_index < 2);
    require(is_in_bytes(point, packet));
    previous_ns = point.time_offset_ns;
  }
}

/// Makes the parts good that random bytes never hit, so that the rest is reached.
void repair(std::vector<std::uint8_t>& payload, std::uint8_t control) {
  if (payload.size() != kVlp16PacketBytes) return;
  for (std::size_t block = 0; block < kVlp16Blocks; ++block) {
    payload[block * 100] = 0xFF;
    payload[block * 100 + 1] = 0xEE;
    if ((control & 2U) == 0) continue;
    const std::size_t step = 20 + (control >> 2U);
    const std::size_t azimuth = (payload[2] * 137U + step * (payload[1204] == 0x39 ? block / 2 : block)) % 36000;
    payload[block * 100 + 2] = static_cast<std::uint8_t>(azimuth);
    payload[block * 100 + 3] = static_cast<std::uint8_t>(azimuth >> 8U);
  }
  payload[1205] = 0x22;
}

void check_position(std::span<const std::uint8_t> payload) {
  const auto position = parse_vlp16_position(payload);
  if (!position) return;
  require(position->nmea.size() <= payload.size() - 206);
  require(position->nmea.find_first_of("\r\n") == std::string_view::npos);
}

}  // namespace

/// Records of: control byte (bit 0: repair, bit 1: azimuths too), arrival step in us (4 bytes), then a payload of up to
/// 1206.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  Vlp16Decoder decoder{{}};
  ByteReader reader{{bytes, size}};
  HostTime arrival{std::chrono::seconds{10}};
  while (reader.remaining() > 5) {
    const std::uint8_t control = reader.u8();
    arrival += std::chrono::microseconds{reader.u32_le()};
    const auto body = reader.take(std::min(reader.remaining(), kVlp16PacketBytes));
    std::vector<std::uint8_t> payload{body.begin(), body.end()};
    if ((control & 1U) != 0) repair(payload, control);
    const LidarPacket* out = decoder.decode(payload, arrival);
    const auto parsed = parse_vlp16(payload);
    if (out != nullptr) {
      require(parsed.cause == LidarRejection::kCount && out->arrival == arrival);
      check(*out, parsed.packet);
    }
    check_position(body.first(std::min(body.size(), kVlp16PositionBytes)));
  }
  require(decoder.stats().received == decoder.stats().accepted + decoder.stats().rejections.total());
  return 0;
}
