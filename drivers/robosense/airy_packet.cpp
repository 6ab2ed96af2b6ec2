#include "drivers/robosense/airy_packet.hpp"

#include "drivers/io/byte_reader.hpp"
#include "drivers/robosense/airy_stamp.hpp"

namespace slamd {
namespace {

constexpr std::uint32_t kHeader = 0x55AA055A;
constexpr std::size_t kDataTypeAt = 16;  // two bytes: kind of data (0 = points), returns
constexpr std::size_t kStampAt = 20;
constexpr std::size_t kModeAt = 32;  // channels: 1 = 48, 2 = 96, 3 = 192
constexpr std::uint8_t kPoints = 0;
constexpr std::uint8_t kDualReturn = 3;
constexpr std::uint16_t kBlockFlag = 0xFFEE;

/// Flags and azimuths of all blocks; the blocks of one column must agree.
LidarRejection read_blocks(AiryPacket& packet) {
  const std::size_t stride = kAiryBlocks / airy_columns(packet.returns);
  for (std::size_t block = 0; block < kAiryBlocks; ++block) {
    ByteReader reader{packet.bytes.subspan(kAiryHeaderBytes + block * kAiryBlockBytes, 4)};
    if (reader.u16_be() != kBlockFlag) return LidarRejection::kBlockFlag;
    const std::uint16_t azimuth_cdeg = reader.u16_be();
    if (azimuth_cdeg >= kFullCircleCdeg) return LidarRejection::kAzimuthRange;
    std::uint16_t& column_cdeg = packet.azimuth_cdeg[block / stride];
    if (block % stride == 0) column_cdeg = azimuth_cdeg;
    if (azimuth_cdeg != column_cdeg) return LidarRejection::kPairMismatch;
  }
  return LidarRejection::kCount;
}

/// Everything before the blocks.
LidarRejection read_header(AiryPacket& packet) {
  if (ByteReader{packet.bytes}.u32_be() != kHeader) return LidarRejection::kHeader;
  if (packet.bytes[kDataTypeAt] != kPoints) return LidarRejection::kDataType;
  const std::uint8_t mode = packet.bytes[kModeAt];
  if (mode == 1 || mode >= 3) return LidarRejection::kUnknownModel;  // 0: firmware that does not tell, of 96 channels
  packet.returns = packet.bytes[kDataTypeAt + 1] == kDualReturn ? AiryReturns::kDual : AiryReturns::kSingle;
  const std::optional<DeviceTime> stamp = read_robosense_stamp(packet.bytes.subspan<kStampAt, kRobosenseStampBytes>());
  if (!stamp) return LidarRejection::kStampRange;
  packet.stamp = *stamp;
  return LidarRejection::kCount;
}

}  // namespace

AiryParsed parse_airy(std::span<const std::uint8_t> payload) {
  static constexpr std::array<std::uint8_t, kAiryPacketBytes> kNoBytes{};
  AiryParsed parsed{LidarRejection::kWrongSize, {kNoBytes, AiryReturns::kSingle, {}, {}}};
  if (payload.size() != kAiryPacketBytes) return parsed;
  parsed.packet.bytes = payload.first<kAiryPacketBytes>();
  parsed.cause = read_header(parsed.packet);
  if (parsed.cause == LidarRejection::kCount) parsed.cause = read_blocks(parsed.packet);
  return parsed;
}

}  // namespace slamd
