#include "estimator/math/geodesy.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <numbers>

namespace slamd {

namespace {

constexpr double kSphereRadius_m = 6'371'000.0;
constexpr double kRadian = std::numbers::pi / 180.0;

}  // namespace

struct LocalEnu::Ellipsoid {
  GeographicLib::LocalCartesian plane;
};

LocalEnu::LocalEnu(const GeodeticPosition& origin, EnuProjection projection)
    : origin_{origin},
      projection_{projection},
      ellipsoid_{std::make_unique<Ellipsoid>(
          Ellipsoid{{origin.latitude_deg, origin.longitude_deg, origin.height_m}})} {}

LocalEnu::~LocalEnu() = default;
LocalEnu::LocalEnu(LocalEnu&&) noexcept = default;
LocalEnu& LocalEnu::operator=(LocalEnu&&) noexcept = default;

Eigen::Vector3d LocalEnu::to_enu(const GeodeticPosition& position) const {
  if (projection_ == EnuProjection::kEquirectangular) {
    const double east_deg = std::remainder(position.longitude_deg - origin_.longitude_deg, 360.0);
    return {kSphereRadius_m * kRadian * east_deg * std::cos(origin_.latitude_deg * kRadian),
            kSphereRadius_m * kRadian * (position.latitude_deg - origin_.latitude_deg),
            position.height_m - origin_.height_m};
  }
  Eigen::Vector3d p;
  ellipsoid_->plane.Forward(position.latitude_deg, position.longitude_deg, position.height_m, p.x(), p.y(), p.z());
  return p;
}

GeodeticPosition LocalEnu::to_geodetic(const Eigen::Vector3d& p_enu) const {
  GeodeticPosition position;
  if (projection_ == EnuProjection::kEquirectangular) {
    const double metres_a_degree = kSphereRadius_m * kRadian;
    return {origin_.latitude_deg + p_enu.y() / metres_a_degree,
            origin_.longitude_deg + p_enu.x() / (metres_a_degree * std::cos(origin_.latitude_deg * kRadian)),
            origin_.height_m + p_enu.z()};
  }
  ellipsoid_->plane.Reverse(p_enu.x(), p_enu.y(), p_enu.z(), position.latitude_deg, position.longitude_deg,
                            position.height_m);
  return position;
}

}  // namespace slamd
