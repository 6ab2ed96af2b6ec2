#include "estimator/math/geodesy.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

constexpr GeodeticPosition kOrigin{48.1374, 11.5755, 560.0};

TEST(LocalEnu, GoesThereAndBack) {
  for (const EnuProjection projection : {EnuProjection::kLocalCartesian, EnuProjection::kEquirectangular}) {
    const LocalEnu enu{kOrigin, projection};
    const Eigen::Vector3d p{1'200.0, -3'400.0, 25.0};
    EXPECT_LT((enu.to_enu(enu.to_geodetic(p)) - p).norm(), 1e-6);
    EXPECT_LT(enu.to_enu(kOrigin).norm(), 1e-9);
  }
}

TEST(LocalEnu, AxesAreEastNorthUp) {
  const LocalEnu enu{kOrigin};
  EXPECT_GT(enu.to_enu({kOrigin.latitude_deg, kOrigin.longitude_deg + 0.001, 560.0}).x(), 70.0);
  EXPECT_GT(enu.to_enu({kOrigin.latitude_deg + 0.001, kOrigin.longitude_deg, 560.0}).y(), 110.0);
  EXPECT_NEAR(enu.to_enu({kOrigin.latitude_deg, kOrigin.longitude_deg, 570.0}).z(), 10.0, 1e-9);
}

TEST(LocalEnu, AcrossTheDateLineDistancesStaySmall) {
  for (const EnuProjection projection : {EnuProjection::kLocalCartesian, EnuProjection::kEquirectangular}) {
    const LocalEnu enu{{-17.0, 179.9995, 0.0}, projection};
    EXPECT_NEAR(enu.to_enu({-17.0, -179.9995, 0.0}).x(), 106.0, 2.0);
  }
}

TEST(LocalEnu, TheEquirectangularPlaneIsOffByWhatItsCommentSays) {
  const LocalEnu exact{kOrigin};
  const LocalEnu plane{kOrigin, EnuProjection::kEquirectangular};
  for (const Eigen::Vector3d& p : {Eigen::Vector3d{0.0, 200.0, 0.0}, {200.0, 0.0, 0.0}, {700.0, 700.0, 0.0}}) {
    const Eigen::Vector3d error = plane.to_enu(exact.to_geodetic(p)) - p;
    EXPECT_LT(error.head<2>().norm(), 0.0034 * p.norm());
  }
  const double height = plane.to_enu(exact.to_geodetic({1'000.0, 0.0, 0.0})).z();
  EXPECT_NEAR(height, 0.078, 0.002);
}

}  // namespace
}  // namespace slamd
