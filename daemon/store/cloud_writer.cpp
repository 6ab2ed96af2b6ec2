#include "daemon/store/cloud_writer.hpp"

#include <liblzf/lzf.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

namespace slamd {
namespace {

constexpr std::size_t kPiecePoints = 65'536;
constexpr std::size_t kMaxPoints = std::size_t{1} << 28U;  // PCD's 32-bit size of the plain bytes
constexpr Error kNotWritten{"the point cloud could not be written"};
constexpr Error kStopped{"the writing was stopped"};
using Field = float CloudPoint::*;
constexpr std::array<Field, 4> kFields{&CloudPoint::x, &CloudPoint::y, &CloudPoint::z, &CloudPoint::intensity};

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 512> line{};
  std::snprintf(line.data(), line.size(), pattern, values...);
  return line.data();
}

std::string reference_lines(const CloudFileOptions& options, const char* prefix) {
  if (!options.reference) return {};
  const GeoReference& r = *options.reference;
  const Eigen::Vector3d& t = r.T_enu_map.translation;
  const Eigen::Quaterniond& q = r.T_enu_map.rotation;
  return format("%s enu_origin_lat_lon_height %.9f %.9f %.4f\n", prefix, r.latitude_deg, r.longitude_deg,
                r.ellipsoid_height_m) +
         format("%s T_enu_map_xyz_quat_xyzw %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", prefix, t.x(), t.y(), t.z(), q.x(),
                q.y(), q.z(), q.w());
}

std::string pcd_header(const CloudSource& source, const CloudFileOptions& options) {
  return "# .PCD v0.7 - Point Cloud Data file format\n" + reference_lines(options, "#") +
         format("VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH %zu\nHEIGHT 1\n"
                "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS %zu\nDATA binary_compressed\n",
                source.size, source.size);
}

std::string ply_header(const CloudSource& source, const CloudFileOptions& options) {
  return "ply\nformat binary_little_endian 1.0\n" + reference_lines(options, "comment") +
         format("element vertex %zu\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
                "end_header\n",
                source.size);
}

bool write_text(int fd, const std::string& text) { return write_all(fd, text.data(), text.size()); }

/// One field of a run of points, compressed. LZF looks back within one call only, so that the pieces written one after
/// the other are the LZF of the whole.
class PiecePacker {
 public:
  /// The packed bytes; valid until the next call.
  std::span<const char> pack(std::span<const CloudPoint> points, Field field) {
    std::transform(points.begin(), points.end(), plain_.begin(), [field](const CloudPoint& p) { return p.*field; });
    const auto bytes = static_cast<unsigned>(points.size() * sizeof(float));
    return {packed_.data(), lzf_compress(plain_.data(), bytes, packed_.data(), static_cast<unsigned>(packed_.size()))};
  }

 private:
  static constexpr std::size_t kPlainBytes = kPiecePoints * sizeof(float);
  std::vector<float> plain_ = std::vector<float>(kPiecePoints);
  std::vector<char> packed_ = std::vector<char>(kPlainBytes + kPlainBytes / 32 + 16);  // room for LZF's worst case
};

/// Calls write(field number, points) piece by piece until it fails or progress says no.
template <class Write>
Result<void> for_each_piece(const CloudSource& source, std::size_t passes, const WriteProgress& progress, Write&& write) {
  PointCloud buffer(std::min(kPiecePoints, source.size));
  const double total = static_cast<double>(std::max<std::size_t>(passes * source.size, 1));
  for (std::size_t pass = 0; pass < passes; ++pass) {
    for (std::size_t begin = 0; begin < source.size; begin += kPiecePoints) {
      if (progress && !progress(static_cast<double>(pass * source.size + begin) / total)) return kStopped;
      const std::span<CloudPoint> piece{buffer.data(), std::min(kPiecePoints, source.size - begin)};
      source.read(begin, piece);
      if (!write(pass, std::span<const CloudPoint>{piece})) return kNotWritten;
    }
  }
  return {};
}

/// Source: the PCD file format, "binary_compressed": sizes of the packed and the plain bytes, then field after field.
Result<void> write_pcd(int fd, const CloudSource& source, const CloudFileOptions& options) {
  const std::string header = pcd_header(source, options);
  std::array<std::uint32_t, 2> sizes{0, static_cast<std::uint32_t>(source.size * sizeof(CloudPoint))};
  const auto write_sizes = [&] { return write_all(fd, reinterpret_cast<const char*>(sizes.data()), sizeof sizes); };
  if (!write_text(fd, header) || !write_sizes()) return kNotWritten;
  PiecePacker packer;
  const auto write_piece = [&](std::size_t field, std::span<const CloudPoint> piece) {
    const std::span<const char> packed = packer.pack(piece, kFields[field]);
    sizes[0] += static_cast<std::uint32_t>(packed.size());
    return !packed.empty() && write_all(fd, packed.data(), packed.size());
  };
  const Result<void> written = for_each_piece(source, kFields.size(), options.progress, write_piece);
  if (!written) return written;
  const bool placed = ::lseek(fd, static_cast<off_t>(header.size()), SEEK_SET) >= 0 && write_sizes();
  return placed ? Result<void>{} : kNotWritten;
}

Result<void> write_ply(int fd, const CloudSource& source, const CloudFileOptions& options) {
  static_assert(sizeof(CloudPoint) == 4 * sizeof(float));
  if (!write_text(fd, ply_header(source, options))) return kNotWritten;
  return for_each_piece(source, 1, options.progress, [fd](std::size_t, std::span<const CloudPoint> piece) {
    return write_all(fd, reinterpret_cast<const char*>(piece.data()), piece.size_bytes());
  });
}

}  // namespace

bool write_all(int fd, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(fd, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

Result<void> write_cloud(int fd, const CloudSource& source, const CloudFileOptions& options) {
  if (source.size > kMaxPoints) return Error{"more points than a file can hold"};
  return options.format == CloudFormat::kPcd ? write_pcd(fd, source, options) : write_ply(fd, source, options);
}

std::string to_yaml(const GeoReference& reference) {
  const Eigen::Vector3d& t = reference.T_enu_map.translation;
  const Eigen::Quaterniond& q = reference.T_enu_map.rotation;
  return format("# p_enu = T_enu_map * p_map; enu is east, north, up at the origin on WGS-84\n"
                "origin_lat_deg: %.9f\norigin_lon_deg: %.9f\norigin_ellipsoid_height_m: %.4f\n",
                reference.latitude_deg, reference.longitude_deg, reference.ellipsoid_height_m) +
         format("T_enu_map:\n  translation_m: [%.6f, %.6f, %.6f]\n  rotation_quat_xyzw: [%.9f, %.9f, %.9f, %.9f]\n",
                t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace slamd
