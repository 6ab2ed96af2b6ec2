#include "daemon/store/planar_checkpoint.hpp"

#include <algorithm>
#include <string_view>

#include "daemon/store/byte_codec.hpp"
#include "daemon/store/checkpoint_file.hpp"

namespace slamd {
namespace {

constexpr std::string_view kMagic = "SLAMDGRD";
constexpr float kUnit_m = 0.005F;
constexpr float kFarthest_m = 160.0F;
constexpr std::size_t kMostPoints = 65'536;

std::vector<std::uint8_t> head_content(const VehicleGeometry& vehicle) {
  ByteWriter out;
  out.number(kPlanarCheckpointVersion);
  out.vehicle(vehicle);
  return std::move(out.bytes());
}

bool fits(const Eigen::Vector2f& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthest_m; }

void write(ByteWriter& out, const Eigen::Vector2f& p) {
  out.number(static_cast<std::int16_t>(std::lround(p.x() / kUnit_m)));
  out.number(static_cast<std::int16_t>(std::lround(p.y() / kUnit_m)));
}

Eigen::Vector2f read_point(ByteReader& in) {
  const auto x = in.number<std::int16_t>();
  const auto y = in.number<std::int16_t>();
  return {kUnit_m * static_cast<float>(x), kUnit_m * static_cast<float>(y)};
}

/// Whether a whole and sound one was there, and now is in the map.
bool read_keyframe(ByteReader& file, StoredPlanarMap& map) {
  const auto size = file.number<std::uint32_t>();
  const auto crc = file.number<std::uint32_t>();
  const std::span<const std::uint8_t> content = file.raw(size);
  if (!file.good() || crc != crc_of(content)) return false;
  ByteReader in{content};
  StoredPlanarKeyframe keyframe;
  keyframe.time = from_ns<HostTime>(in.number<std::int64_t>());
  in.numbers({keyframe.pose.data(), 3});
  keyframe.origin = read_point(in);
  const auto count = in.number<std::uint32_t>();
  if (!in.good() || count > kMostPoints || (!map.empty() && keyframe.time <= map.back().time)) return false;
  for (std::uint32_t i = 0; i < count && in.good(); ++i) keyframe.points.push_back(read_point(in));
  if (!in.at_end()) return false;
  map.push_back(std::move(keyframe));
  return true;
}

}  // namespace

std::vector<std::uint8_t> encode_planar_head(const VehicleGeometry& vehicle) {
  const std::vector<std::uint8_t> content = head_content(vehicle);
  ByteWriter out;
  out.raw({reinterpret_cast<const std::uint8_t*>(kMagic.data()), kMagic.size()});
  out.raw(content);
  out.number(crc_of(content));
  return std::move(out.bytes());
}

std::vector<std::uint8_t> encode(const StoredPlanarKeyframe& keyframe) {
  ByteWriter out;
  out.number(std::uint64_t{0});  // sealed below
  out.number(to_ns(keyframe.time));
  out.numbers({keyframe.pose.data(), 3});
  write(out, keyframe.origin);
  const auto all = std::ranges::count_if(keyframe.points, fits);
  out.number(static_cast<std::uint32_t>(std::min<std::size_t>(static_cast<std::size_t>(all), kMostPoints)));
  std::size_t written = 0;
  for (const Eigen::Vector2f& p : keyframe.points) {
    if (!fits(p) || written == kMostPoints) continue;
    write(out, p);
    ++written;
  }
  seal(out.bytes(), out.bytes().size() - sizeof(std::uint64_t));
  return std::move(out.bytes());
}

Result<StoredPlanarMap> decode_planar(std::span<const std::uint8_t> bytes, const VehicleGeometry& vehicle) {
  ByteReader file{bytes};
  const std::span<const std::uint8_t> magic = file.raw(kMagic.size());
  if (!std::ranges::equal(magic, kMagic)) return Error{"this is no checkpoint of planar mode"};
  const std::vector<std::uint8_t> own = head_content(vehicle);
  const std::span<const std::uint8_t> head = file.raw(own.size());
  const auto crc = file.number<std::uint32_t>();
  if (!file.good() || crc != crc_of(head)) return Error{"the checkpoint is damaged or torn"};
  if (!std::ranges::equal(head.first(sizeof kPlanarCheckpointVersion), std::span{own}.first(sizeof kPlanarCheckpointVersion)))
    return Error{"the checkpoint is of another version"};
  if (!std::ranges::equal(head, own)) return Error{"the checkpoint is of another vehicle, or the sensors have been moved"};
  StoredPlanarMap map;
  while (read_keyframe(file, map)) {
  }
  return map;
}

Result<StoredPlanarMap> load_planar_checkpoint(const std::string& path, const VehicleGeometry& vehicle) {
  const Result<std::vector<std::uint8_t>> bytes = read_checkpoint(path);
  if (!bytes) return Error{bytes.reason()};
  if (bytes->empty()) return StoredPlanarMap{};
  return decode_planar(*bytes, vehicle);
}

}  // namespace slamd
