#pragma once
// Numbers to the bytes of a file and back, little-endian as they lie in memory, with their checksum. It knows no file and no format.

#include <array>
#include <bit>
#include <boost/crc.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "estimator/types/pose.hpp"

namespace slamd {

static_assert(std::endian::native == std::endian::little);

/// CRC-32.
inline std::uint32_t crc_of(std::span<const std::uint8_t> bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

/// Appends values to bytes.
class ByteWriter {
 public:
  template <class T>
  void number(T value) {
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), raw, raw + sizeof value);
  }
  void numbers(std::span<const double> values) {
    for (const double value : values) number(value);
  }
  void pose(const Pose& T) {
    numbers({T.translation.data(), 3});
    numbers({T.rotation.coeffs().data(), 4});
  }
  void vehicle(const VehicleGeometry& vehicle) {
    pose(vehicle.T_base_lidar);
    pose(vehicle.T_base_imu);
    numbers({vehicle.p_base_antenna.data(), 3});
  }
  void raw(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads what is there; what is not, or is no sound value, makes it bad for good.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : left_{bytes} {}

  template <class T>
  T number() {
    T value{};
    if (left_.size() < sizeof value) {
      good_ = false;
      return value;
    }
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  void numbers(std::span<double> values) {
    for (double& value : values) {
      value = number<double>();
      good_ = good_ && std::isfinite(value);
    }
  }
  Pose pose() {
    Pose T;
    numbers({T.translation.data(), 3});
    numbers({T.rotation.coeffs().data(), 4});
    good_ = good_ && std::abs(T.rotation.norm() - 1.0) < kUnit;
    return T;
  }
  std::span<const std::uint8_t> raw(std::size_t size) {
    good_ = good_ && size <= left_.size();
    const std::span<const std::uint8_t> bytes = left_.first(good_ ? size : 0);
    left_ = left_.subspan(bytes.size());
    return bytes;
  }
  bool good() const { return good_; }
  bool at_end() const { return good_ && left_.empty(); }

 private:
  static constexpr double kUnit = 1e-6;  // that a quaternion's norm may be off

  std::span<const std::uint8_t> left_;
  bool good_ = true;
};

/// Its size and checksum into the bytes before the last `size`.
inline void seal(std::vector<std::uint8_t>& bytes, std::size_t size) {
  const std::array<std::uint32_t, 2> seal{static_cast<std::uint32_t>(size), crc_of(std::span{bytes}.last(size))};
  std::memcpy(bytes.data() + bytes.size() - size - sizeof seal, seal.data(), sizeof seal);
}

}  // namespace slamd
