#pragma once
// WGS-84 positions as metres in a local east-north-up frame. GeographicLib does the work; no sensor, no noise here.

#include <Eigen/Core>
#include <cstdint>
#include <memory>

namespace slamd {

/// How the ellipsoid becomes a plane.
enum class EnuProjection : std::uint8_t {
  kLocalCartesian,   // exact: tangent plane, the earth's curvature is in the height
  kEquirectangular,  // a sphere's degrees as metres, as the paper has it: off by up to 0.34 % of the distance north and south,
                     // 0.67 m at 200 m, and its height ignores the curvature (7.8 cm at 1 km)
};

struct GeodeticPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;  // above the ellipsoid
};

class LocalEnu {
 public:
  explicit LocalEnu(const GeodeticPosition& origin, EnuProjection projection = EnuProjection::kLocalCartesian);
  ~LocalEnu();
  LocalEnu(LocalEnu&&) noexcept;
  LocalEnu& operator=(LocalEnu&&) noexcept;

  const GeodeticPosition& origin() const { return origin_; }
  /// Metres east, north, up of the origin.
  Eigen::Vector3d to_enu(const GeodeticPosition& position) const;
  /// Inverse of to_enu.
  GeodeticPosition to_geodetic(const Eigen::Vector3d& p_enu) const;

 private:
  struct Ellipsoid;

  GeodeticPosition origin_;
  EnuProjection projection_;
  std::unique_ptr<Ellipsoid> ellipsoid_;
};

}  // namespace slamd
