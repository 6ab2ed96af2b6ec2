// Checkpoints: any bytes, and the same behind a right head with a right checksum. Properties: what is taken is finite, in order
// and encodes to bytes that are taken again and equal; nothing is read beyond the end; a mapper takes whatever was taken.

#include <boost/crc.hpp>
#include <cstdlib>
#include <cstring>

#include "daemon/store/checkpoint_file.hpp"
#include "estimator/graph/back_end.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

void check(std::span<const std::uint8_t> bytes) {
  Result<StoredMap> map = decode(bytes, {});
  if (!map) return;
  for (std::size_t i = 0; i < map->keyframes.size(); ++i) {
    require(map->keyframes[i].T_map_base.translation.allFinite() && map->keyframes[i].relative_covariance.allFinite());
    require(i == 0 || map->keyframes[i - 1].time < map->keyframes[i].time);
  }
  const std::vector<std::uint8_t> again = encode(*map, {});
  const Result<StoredMap> back = decode(again, {});
  require(static_cast<bool>(back) && encode(*back, {}) == again);
  BackEndConfig config;
  config.use_gps = false;
  Relocaliser back_end = make_relocaliser(config, {});
  back_end.restore(std::move(map).value(), HostTime{std::chrono::seconds{1}});
}

/// The input as what follows the vehicle in a checkpoint whose checksum is right.
std::vector<std::uint8_t> sealed(std::span<const std::uint8_t> content) {
  constexpr std::size_t kHeadBytes = 20;
  constexpr std::size_t kVehicleBytes = 17 * sizeof(double);
  std::vector<std::uint8_t> bytes = encode({}, {});
  bytes.resize(kHeadBytes + kVehicleBytes);
  bytes.insert(bytes.end(), content.begin(), content.end());
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data() + kHeadBytes, bytes.size() - kHeadBytes);
  const std::uint32_t seal[] = {static_cast<std::uint32_t>(bytes.size() - kHeadBytes), crc.checksum()};
  std::memcpy(bytes.data() + kHeadBytes - sizeof seal, seal, sizeof seal);
  return bytes;
}

/// The input as a step, whose checksum is right, of a map of one keyframe.
std::vector<std::uint8_t> stepped(std::span<const std::uint8_t> content) {
  StoredMap map;
  map.keyframes.resize(1);
  std::vector<std::uint8_t> bytes = encode(map, {});
  boost::crc_32_type crc;
  crc.process_bytes(content.data(), content.size());
  const std::uint32_t seal[] = {static_cast<std::uint32_t>(content.size()), crc.checksum()};
  const auto* raw = reinterpret_cast<const std::uint8_t*>(seal);
  bytes.insert(bytes.end(), raw, raw + sizeof seal);
  bytes.insert(bytes.end(), content.begin(), content.end());
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  check({input, size});
  check(sealed({input, size}));
  check(stepped({input, size}));
  return 0;
}
