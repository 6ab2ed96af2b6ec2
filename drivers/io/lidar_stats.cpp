#include "drivers/io/lidar_stats.hpp"

namespace slamd {
namespace {

struct CauseText {
  const char* name;
  const char* sentence;
};

/// In the order of LidarRejection.
constexpr std::array<CauseText, static_cast<std::size_t>(LidarRejection::kCount) + 1> kTexts = {{
    {"wrong_size", "the payload is not as long as a data packet of this LiDAR (VLP-16 1206 bytes, Airy 1248)"},
    {"header", "the payload does not begin as a data packet of this LiDAR: check lidar.model and the port numbers"},
    {"position_packet", "a VLP-16 position packet on the data port: check the port numbers"},
    {"hdl_32e", "the sensor is a Velodyne HDL-32E (product byte 0x21), not a VLP-16"},
    {"hdl_64e", "the packet has lower-block flags (0xDDFF): a Velodyne HDL-64E, not a VLP-16"},
    {"puck_hi_res", "the sensor is a Velodyne Puck Hi-Res (product byte 0x24), not a VLP-16"},
    {"vlp_32c", "the sensor is a Velodyne VLP-32C (product byte 0x28), not a VLP-16"},
    {"vls_128", "the sensor is a Velodyne VLS-128 (product byte 0xA1), not a VLP-16"},
    {"velarray", "the sensor is a Velodyne Velarray (product byte 0x31), not a VLP-16"},
    {"unknown_model", "the packet names another model than lidar.model (VLP-16: product byte 0x22; Airy: 96 channels)"},
    {"data_type", "the packet holds something else than points"},
    {"return_mode", "the return mode is none of strongest, last and dual"},
    {"block_flag", "a data block does not begin with its flag"},
    {"azimuth_range", "a block's azimuth is 360 degrees or more"},
    {"stamp_range", "the time stamp is none"},
    {"pair_mismatch", "blocks of the same firings have different azimuths"},
    {"checksum", "the checksum of a packet is wrong"},
    {"no_angles", "the sensor has not told the directions of its beams yet: check lidar.position_port"},
    {"stopped", "the sensor turns slower than allowed, or stands"},
    {"too_fast", "the sensor turns faster than allowed"},
    {"azimuth_jump", "the azimuth does not advance evenly"},
    {"out_of_order", "the packet is repeated or late"},
    {"stamp_jump", "the time stamp contradicts the packet's arrival"},
    {"none", "accepted"},
}};

}  // namespace

const char* name(LidarRejection cause) {
  return kTexts[static_cast<std::size_t>(cause)].name;
}
const char* explain(LidarRejection cause) {
  return kTexts[static_cast<std::size_t>(cause)].sentence;
}

LidarRejection rejection_of(RotationFault fault) {
  if (fault == RotationFault::kUneven) return LidarRejection::kAzimuthJump;
  return fault == RotationFault::kTooSlow ? LidarRejection::kStopped : LidarRejection::kTooFast;
}

LidarRejection rejection_of(PacketVerdict verdict) {
  if (verdict == PacketVerdict::kAzimuthJump) return LidarRejection::kAzimuthJump;
  return verdict == PacketVerdict::kOutOfOrder ? LidarRejection::kOutOfOrder : LidarRejection::kStampJump;
}

}  // namespace slamd
