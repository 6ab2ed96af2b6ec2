#pragma once
// A stored planar map as the bytes of a file: of a known version, of this vehicle, each keyframe sealed by its own checksum, so that
// a file whose end is torn is good up to there. Files themselves are written by checkpoint_file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/result.hpp"
#include "estimator/types/stored_planar_map.hpp"

namespace slamd {

inline constexpr std::uint32_t kPlanarCheckpointVersion = 1;

/// Little-endian: "SLAMDGRD", u32 version, the vehicle's geometry, u32 CRC-32 of version and vehicle. Keyframes follow.
std::vector<std::uint8_t> encode_planar_head(const VehicleGeometry& vehicle);
/// u32 bytes, u32 CRC-32 of them, and they. Points to half a centimetre; those beyond 160 m are left out.
std::vector<std::uint8_t> encode(const StoredPlanarKeyframe& keyframe);

/// Any bytes: refused with a reason unless they begin with a head of this version and vehicle. Keyframes up to the first that is
/// torn, damaged or unsound.
Result<StoredPlanarMap> decode_planar(std::span<const std::uint8_t> bytes, const VehicleGeometry& vehicle);
/// An empty map when there is no such file.
Result<StoredPlanarMap> load_planar_checkpoint(const std::string& path, const VehicleGeometry& vehicle);

}  // namespace slamd
