#include "drivers/velodyne/vlp16_packet.hpp"

#include <algorithm>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kStampAt = kVlp16Blocks * kBlockBytes;
constexpr std::uint16_t kBlockFlag = 0xEEFF;       // bytes FF EE
constexpr std::uint16_t kLowerBlockFlag = 0xDDFF;  // lasers 32..63 of 64- and 128-beam models
constexpr std::uint8_t kProductVlp16 = 0x22;       // VLP-16 and Puck LITE
constexpr std::uint32_t kHourUs = 3'600'000'000U;
constexpr std::size_t kPositionStampAt = 198;
constexpr std::size_t kPositionNmeaAt = 206;

/// kCount for a VLP-16.
LidarRejection model_of(std::uint8_t product) {
  using enum LidarRejection;
  switch (product) {
    case kProductVlp16:
      return kCount;
    case 0x21:
      return kHdl32e;
    case 0x24:
      return kPuckHiRes;
    case 0x28:
      return kVlp32c;
    case 0x31:
      return kVelarray;
    case 0xA1:
      return kVls128;
    default:
      return kUnknownModel;
  }
}

bool is_return_mode(std::uint8_t mode) {
  return mode >= 0x37 && mode <= 0x39;
}

/// Flags and azimuths of all blocks.
LidarRejection read_blocks(Vlp16Packet& packet) {
  for (std::size_t block = 0; block < kVlp16Blocks; ++block) {
    ByteReader reader{packet.bytes.subspan(block * kBlockBytes, 4)};
    if (reader.u16_le() != kBlockFlag) return LidarRejection::kBlockFlag;
    packet.azimuth_cdeg[block] = reader.u16_le();
    if (packet.azimuth_cdeg[block] >= kFullCircleCdeg) return LidarRejection::kAzimuthRange;
    const bool second_of_pair = packet.mode == Vlp16ReturnMode::kDual && block % 2 == 1;
    if (second_of_pair && packet.azimuth_cdeg[block] != packet.azimuth_cdeg[block - 1]) {
      return LidarRejection::kPairMismatch;
    }
  }
  return LidarRejection::kCount;
}

/// An HDL-64E sends no model byte (its last bytes cycle through status values, 0x22 too), but every second block is of
/// its lower lasers and flagged so.
bool has_lower_blocks(std::span<const std::uint8_t, kVlp16PacketBytes> bytes) {
  ByteReader reader{bytes.subspan(kBlockBytes, 2)};
  return reader.u16_le() == kLowerBlockFlag;
}

}  // namespace

Vlp16Parsed parse_vlp16(std::span<const std::uint8_t> payload) {
  static constexpr std::array<std::uint8_t, kVlp16PacketBytes> kNoBytes{};
  Vlp16Parsed parsed{LidarRejection::kCount, {kNoBytes, Vlp16ReturnMode::kStrongest, 0, {}}};
  if (payload.size() != kVlp16PacketBytes) {
    const bool position = payload.size() == kVlp16PositionBytes;
    parsed.cause = position ? LidarRejection::kPositionPacket : LidarRejection::kWrongSize;
    return parsed;
  }
  const auto bytes = payload.first<kVlp16PacketBytes>();
  ByteReader tail{bytes.subspan(kStampAt)};
  const std::uint32_t stamp_us = tail.u32_le();
  const std::uint8_t mode = tail.u8();
  parsed.cause = model_of(tail.u8());
  if (parsed.cause != LidarRejection::kVls128 && has_lower_blocks(bytes)) parsed.cause = LidarRejection::kHdl64e;
  if (parsed.cause != LidarRejection::kCount) return parsed;

  if (!is_return_mode(mode)) {
    parsed.cause = LidarRejection::kReturnMode;
  } else if (stamp_us >= kHourUs) {
    parsed.cause = LidarRejection::kStampRange;
  } else {
    parsed.packet = {bytes, Vlp16ReturnMode{mode}, stamp_us, {}};
    parsed.cause = read_blocks(parsed.packet);
  }
  return parsed;
}

const char* name(PpsState state) {
  switch (state) {
    case PpsState::kAbsent:
      return "absent";
    case PpsState::kSynchronising:
      return "synchronising";
    case PpsState::kLocked:
      return "locked";
    case PpsState::kError:
      return "error";
  }
  return "unknown";
}

Result<Vlp16Position> parse_vlp16_position(std::span<const std::uint8_t> payload) {
  if (payload.size() != kVlp16PositionBytes) return Error{"not a VLP-16 position packet: not 512 bytes long"};
  ByteReader reader{payload.subspan(kPositionStampAt)};
  const std::uint32_t stamp_us = reader.u32_le();
  const std::uint8_t pps = reader.u8();
  if (stamp_us >= kHourUs) return Error{"the position packet's time stamp is one hour or more"};
  if (pps > static_cast<std::uint8_t>(PpsState::kError)) return Error{"the position packet's PPS state is unknown"};

  const auto tail = payload.subspan(kPositionNmeaAt);
  const auto is_end = [](std::uint8_t byte) { return byte == 0 || byte == '\r' || byte == '\n'; };
  const auto end = std::find_if(tail.begin(), tail.end(), is_end);
  const auto length = static_cast<std::size_t>(end - tail.begin());
  return Vlp16Position{stamp_us, PpsState{pps}, {reinterpret_cast<const char*>(tail.data()), length}};
}

}  // namespace slamd
