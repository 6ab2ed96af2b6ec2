#include "daemon/store/checkpoint_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string_view>

#include "daemon/store/byte_codec.hpp"
#include "daemon/store/cloud_file.hpp"

namespace slamd {
namespace {

constexpr std::string_view kMagic = "SLAMDMAP";
constexpr std::size_t kHeadBytes = kMagic.size() + 3 * sizeof(std::uint32_t);

void write(ByteWriter& out, const StoredEnu& enu) {
  out.number(enu.yaw_rad);
  out.numbers({enu.translation.data(), 3});
  out.numbers(enu.covariance);
  out.numbers(std::array{enu.latitude_deg, enu.longitude_deg, enu.ellipsoid_height_m});
}

StoredEnu read_enu(ByteReader& in) {
  StoredEnu enu;
  in.numbers({&enu.yaw_rad, 1});
  in.numbers({enu.translation.data(), 3});
  in.numbers(enu.covariance);
  in.numbers({&enu.latitude_deg, 1});
  in.numbers({&enu.longitude_deg, 1});
  in.numbers({&enu.ellipsoid_height_m, 1});
  return enu;
}

void write(ByteWriter& out, const StoredKeyframe& keyframe) {
  out.number(to_ns(keyframe.time));
  out.pose(keyframe.T_map_base);
  out.numbers({keyframe.relative_covariance.data(), 36});
  out.number(static_cast<std::uint32_t>(keyframe.cloud.size()));
  out.raw(keyframe.cloud);
}

StoredKeyframe read_keyframe(ByteReader& in) {
  StoredKeyframe keyframe;
  keyframe.time = from_ns<HostTime>(in.number<std::int64_t>());
  keyframe.T_map_base = in.pose();
  in.numbers({keyframe.relative_covariance.data(), 36});
  const std::span<const std::uint8_t> cloud = in.raw(in.number<std::uint32_t>());
  keyframe.cloud.assign(cloud.begin(), cloud.end());
  return keyframe;
}

void write(ByteWriter& out, const StoredSensors& sensors) {
  out.numbers({sensors.gyro_bias_rads.data(), 3});
  out.numbers({sensors.accel_bias_mps2.data(), 3});
  out.pose(sensors.T_imu_lidar);
}

StoredSensors read_sensors(ByteReader& in) {
  StoredSensors sensors;
  in.numbers({sensors.gyro_bias_rads.data(), 3});
  in.numbers({sensors.accel_bias_mps2.data(), 3});
  sensors.T_imu_lidar = in.pose();
  return sensors;
}

void write(ByteWriter& out, const StoredMotion& motion) {
  out.number(to_ns(motion.time));
  out.number(motion.host_to_utc.count());
  out.numbers({motion.velocity_mps.data(), 3});
  out.numbers({motion.angular_velocity_rads.data(), 3});
}

StoredMotion read_motion(ByteReader& in) {
  StoredMotion motion;
  motion.time = from_ns<HostTime>(in.number<std::int64_t>());
  motion.host_to_utc = Duration{in.number<std::int64_t>()};
  in.numbers({motion.velocity_mps.data(), 3});
  in.numbers({motion.angular_velocity_rads.data(), 3});
  return motion;
}

void write(ByteWriter& out, const StoredClosure& closure) {
  out.number(closure.from);
  out.number(closure.to);
  out.pose(closure.T_from_to);
  out.numbers({closure.covariance.data(), 36});
}

StoredClosure read_closure(ByteReader& in) {
  StoredClosure closure;
  closure.from = in.number<std::uint32_t>();
  closure.to = in.number<std::uint32_t>();
  closure.T_from_to = in.pose();
  in.numbers({closure.covariance.data(), 36});
  return closure;
}

Result<StoredMap> read_map(ByteReader& in) {
  StoredMap map;
  map.T_map_base = in.pose();
  map.sensors = read_sensors(in);
  if (in.number<std::uint32_t>() != 0) map.motion = read_motion(in);
  map.enu_valid = in.number<std::uint32_t>() != 0;
  if (map.enu_valid) map.enu = read_enu(in);
  const auto count = in.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && in.good(); ++i) {
    map.keyframes.push_back(read_keyframe(in));
    const bool in_order = i == 0 || map.keyframes[i - 1].time < map.keyframes[i].time;
    if (!in_order) return Error{"the checkpoint's keyframes are out of order"};
  }
  const auto closures = in.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < closures && in.good(); ++i) {
    map.closures.push_back(read_closure(in));
    const StoredClosure& closure = map.closures.back();
    if (closure.from >= closure.to || closure.to >= map.keyframes.size()) return Error{"the checkpoint's closures are of no keyframes"};
  }
  if (!in.at_end()) return Error{"the checkpoint's content is unsound"};
  return map;
}

/// Whether a whole and sound one was there, and now is in the map.
bool read_step(ByteReader& in, StoredMap& map) {
  const auto size = in.number<std::uint32_t>();
  const auto crc = in.number<std::uint32_t>();
  const std::span<const std::uint8_t> bytes = in.raw(size);
  if (!in.good() || crc != crc_of(bytes)) return false;
  ByteReader step{bytes};
  StoredKeyframe keyframe = read_keyframe(step);
  const StoredMotion motion = read_motion(step);
  const StoredSensors sensors = read_sensors(step);
  if (!step.at_end() || map.keyframes.empty() || keyframe.time <= map.keyframes.back().time) return false;
  keyframe.T_map_base = map.keyframes.back().T_map_base * keyframe.T_map_base;
  keyframe.T_map_base.rotation.normalize();
  if (!keyframe.T_map_base.translation.allFinite() || !keyframe.T_map_base.rotation.coeffs().allFinite()) return false;
  map.T_map_base = keyframe.T_map_base;
  map.motion = motion;
  map.sensors = sensors;
  map.keyframes.push_back(std::move(keyframe));
  return true;
}

}  // namespace

std::vector<std::uint8_t> encode(const StoredMap& map, const VehicleGeometry& vehicle) {
  ByteWriter out;
  out.raw({reinterpret_cast<const std::uint8_t*>(kMagic.data()), kMagic.size()});
  out.number(kCheckpointVersion);
  out.number(std::uint64_t{0});  // sealed below
  out.vehicle(vehicle);
  out.pose(map.T_map_base);
  write(out, map.sensors);
  out.number(static_cast<std::uint32_t>(map.motion ? 1 : 0));
  if (map.motion) write(out, *map.motion);
  out.number(static_cast<std::uint32_t>(map.enu_valid ? 1 : 0));
  if (map.enu_valid) write(out, map.enu);
  out.number(static_cast<std::uint32_t>(map.keyframes.size()));
  for (const StoredKeyframe& keyframe : map.keyframes) write(out, keyframe);
  out.number(static_cast<std::uint32_t>(map.closures.size()));
  for (const StoredClosure& closure : map.closures) write(out, closure);
  seal(out.bytes(), out.bytes().size() - kHeadBytes);
  return std::move(out.bytes());
}

std::vector<std::uint8_t> encode(const StoredStep& step) {
  ByteWriter out;
  out.number(std::uint64_t{0});  // sealed below
  write(out, StoredKeyframe{step.time, step.T_before_this, step.relative_covariance, step.cloud});
  write(out, step.motion);
  write(out, step.sensors);
  seal(out.bytes(), out.bytes().size() - sizeof(std::uint64_t));
  return std::move(out.bytes());
}

Result<StoredMap> decode(std::span<const std::uint8_t> bytes, const VehicleGeometry& vehicle) {
  ByteReader file{bytes};
  const std::span<const std::uint8_t> magic = file.raw(kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), kMagic.begin(), kMagic.end())) return Error{"this is no checkpoint"};
  if (file.number<std::uint32_t>() != kCheckpointVersion) return Error{"the checkpoint is of another version"};
  const auto size = file.number<std::uint32_t>();
  const auto crc = file.number<std::uint32_t>();
  const std::span<const std::uint8_t> content = file.raw(size);
  if (!file.good() || crc != crc_of(content)) return Error{"the checkpoint is damaged or torn"};
  ByteReader in{content};
  ByteWriter own;
  own.vehicle(vehicle);
  const std::span<const std::uint8_t> stored = in.raw(own.bytes().size());
  if (!std::equal(stored.begin(), stored.end(), own.bytes().begin(), own.bytes().end())) {
    return Error{"the checkpoint is of another vehicle, or the sensors have been moved"};
  }
  Result<StoredMap> whole = read_map(in);
  if (!whole) return whole;
  StoredMap map = std::move(whole).value();
  while (read_step(file, map)) {
  }
  return map;
}

Result<std::vector<std::uint8_t>> read_checkpoint(const std::string& path) {
  const UniqueFd file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)};
  if (!file && errno == ENOENT) return std::vector<std::uint8_t>{};
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return Error{"the checkpoint cannot be read"};
  if (static_cast<std::size_t>(status.st_size) > kMaxCheckpointBytes) return Error{"the checkpoint is too long"};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.st_size));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return Error{"the checkpoint cannot be read"};
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

Result<StoredMap> load_checkpoint(const std::string& path, const VehicleGeometry& vehicle) {
  const Result<std::vector<std::uint8_t>> bytes = read_checkpoint(path);
  if (!bytes) return Error{bytes.reason()};
  if (bytes->empty()) return StoredMap{};
  return decode(*bytes, vehicle);
}

Result<void> append_to_checkpoint(std::span<const std::uint8_t> bytes, const std::string& path) {
  const UniqueFd file{::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW)};
  if (!file) return Error{"the checkpoint cannot be added to"};
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return Error{"the checkpoint cannot be added to"};
    done += static_cast<std::size_t>(put);
  }
  return {};
}

Result<void> write_checkpoint(std::span<const std::uint8_t> bytes, const std::string& path) {
  const Result<UniqueFd> content = text_memfd({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!content) return Error{content.reason()};
  return save_atomically(content->get(), path);
}

}  // namespace slamd
