#pragma once
// A stored map as the bytes of a file, and the file: checksummed, of a known version, of this vehicle, bounded; the map there whole
// or not at all, and after it what it has gained since, step by step, each there whole or the last. It believes nothing: whether
// the vehicle is still there is for registration to say.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/result.hpp"
#include "estimator/types/stored_map.hpp"

namespace slamd {

inline constexpr std::uint32_t kCheckpointVersion = 3;
/// Of a file; a longer one is not read.
inline constexpr std::size_t kMaxCheckpointBytes = 1ULL << 30U;

/// Little-endian: "SLAMDMAP", u32 version, u32 bytes of the map, u32 CRC-32 of them, and they: vehicle, pose, sensors, motion, place on
/// the earth, keyframes, closures. Steps follow.
std::vector<std::uint8_t> encode(const StoredMap& map, const VehicleGeometry& vehicle);
/// u32 bytes, u32 CRC-32 of them, and they.
std::vector<std::uint8_t> encode(const StoredStep& step);

/// Any bytes: refused with a reason unless they begin with a whole, undamaged map of this version and of just this vehicle, with
/// finite numbers, unit quaternions, times in order and closures between keyframes that are there. The steps after it are added to it,
/// up to the first that is torn, damaged or unsound.
Result<StoredMap> decode(std::span<const std::uint8_t> bytes, const VehicleGeometry& vehicle);

/// The bytes of a file of at most kMaxCheckpointBytes; none (no error) when there is no such file.
Result<std::vector<std::uint8_t>> read_checkpoint(const std::string& path);

/// Both at once: a map without keyframes when there is no such file.
Result<StoredMap> load_checkpoint(const std::string& path, const VehicleGeometry& vehicle);

/// Written beside `path`, synced and renamed: on any error (disk full) `path` is as it was. Mode 0640.
Result<void> write_checkpoint(std::span<const std::uint8_t> bytes, const std::string& path);
/// At the end of the file that write_checkpoint has made, not synced: it outlives the process, not a power cut.
Result<void> append_to_checkpoint(std::span<const std::uint8_t> bytes, const std::string& path);

}  // namespace slamd
