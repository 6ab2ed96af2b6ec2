#include "drivers/gnss/gnss_noise.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

GnssEpoch epoch(unsigned satellites, double hdop) {
  GnssEpoch e;
  e.gga = GgaMessage{};
  e.gga->satellites = satellites;
  e.gga->hdop = hdop;
  return e;
}

double horizontal(const GnssEpoch& e, GnssQuality quality = GnssQuality::kAutonomous) {
  return estimate_sigma(e, quality, {}).horizontal_m;
}

TEST(GnssNoise, StaysWithinOneAndFiveMetres) {
  EXPECT_EQ(horizontal(epoch(14, 0.5)), 1.0);
  EXPECT_EQ(horizontal(epoch(3, 20.0)), 5.0);
  GnssEpoch e = epoch(12, 1.0);
  e.gst = GstMessage{{}, 0.01, 0.01, 0.02};
  EXPECT_EQ(horizontal(e), 1.0);
  e.gst = GstMessage{{}, 40.0, 30.0, 90.0};
  EXPECT_EQ(horizontal(e), 5.0);
  EXPECT_EQ(estimate_sigma(e, GnssQuality::kAutonomous, {}).vertical_m, 9.0);
}

TEST(GnssNoise, GstGoesBeforeDilution) {
  GnssEpoch e = epoch(12, 1.0);
  e.gst = GstMessage{{}, 3.0, 3.0, 4.0};
  EXPECT_NEAR(horizontal(e), 3.0, 1e-12);
  EXPECT_NEAR(estimate_sigma(e, GnssQuality::kAutonomous, {}).vertical_m, 4.0, 1e-12);
  e.gst->sigma_east_m.reset();
  EXPECT_NEAR(horizontal(e), 1.25, 1e-12);
}

TEST(GnssNoise, GrowsWithDilutionAndWithMissingSatellites) {
  EXPECT_LT(horizontal(epoch(10, 1.0)), horizontal(epoch(10, 2.0)));
  EXPECT_LT(horizontal(epoch(10, 2.0)), horizontal(epoch(5, 2.0)));
  EXPECT_LT(horizontal(epoch(10, 2.0), GnssQuality::kDifferential), horizontal(epoch(10, 2.0)));
}

TEST(GnssNoise, UnknownSimulatedAndReckonedFixesAreWeak) {
  EXPECT_EQ(horizontal(GnssEpoch{}), 5.0);
  EXPECT_EQ(horizontal(epoch(12, 0.8), GnssQuality::kSimulated), 5.0);
  EXPECT_EQ(horizontal(epoch(12, 0.8), GnssQuality::kDeadReckoning), 5.0);
}

TEST(GnssNoise, TakesTheDilutionOfGsaWhereGgaHasNone) {
  GnssEpoch e = epoch(10, 0.0);
  e.gsa = GsaMessage{3, 2.0};
  EXPECT_NEAR(horizontal(e), 2.5, 1e-12);
}

}  // namespace
}  // namespace slamd
