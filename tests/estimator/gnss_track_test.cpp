#include "estimator/graph/gnss_track.hpp"

#include <gtest/gtest.h>

namespace slamd {
namespace {

const Eigen::Vector3d kAntenna{-0.6, 0.35, 1.74};
constexpr double kStep_m = 1.5;  // between keyframes

HostTime at(double s) { return HostTime{from_seconds(s)}; }

Keyframe keyframe(double t_s, double x_m, double speed_mps) {
  Keyframe out;
  out.state.time = at(t_s);
  out.state.T_odom_base.translation = {x_m, 0.0, 0.0};
  out.state.velocity_mps = {speed_mps, 0.0, 0.0};
  return out;
}

std::optional<TiedFix> tied(const GnssTrack& track, double t_s) {
  GnssFix fix;
  fix.quality = GnssQuality::kAutonomous;
  fix.sigma_horizontal_m = 1.0;
  return track.tie(fix, at(t_s), Eigen::Vector3d::Zero());
}

TEST(GnssTrack, AFixIsTiedWhereTheAntennaWasAtAnySteadySpeed) {
  for (const double speed_mps : {0.4, 0.8, 1.4, 3.0, 10.0}) {
    GnssTrack track{kAntenna};
    for (int i = 0; i < 3; ++i) track.add(keyframe(i * kStep_m / speed_mps, i * kStep_m, speed_mps));
    const double t_s = 1.3 * kStep_m / speed_mps;
    const std::optional<TiedFix> fix = tied(track, t_s);
    ASSERT_TRUE(fix) << speed_mps;
    EXPECT_EQ(fix->position.keyframe, 1U);
    const Eigen::Vector3d expected = Eigen::Vector3d{0.3 * kStep_m, 0.0, 0.0} + kAntenna;
    EXPECT_LT((fix->position.p_keyframe_antenna - expected).norm(), 1e-6) << speed_mps;
    EXPECT_NEAR(fix->velocity_odom_mps.x(), speed_mps, 0.01 * speed_mps);
  }
}

TEST(GnssTrack, WhereItMayHaveStoodNoFixIsTied) {
  GnssTrack track{kAntenna};
  track.add(keyframe(0.0, 0.0, 1.0));
  track.add(keyframe(4.0, kStep_m, 1.0));        // 1.5 s of driving, 2.5 s of standing
  track.add(keyframe(5.5, 2 * kStep_m, 1.0));
  track.add(keyframe(8.5, 3 * kStep_m, 0.0));    // braked to a stop
  track.add(keyframe(15.0, 4 * kStep_m, 0.23));  // crept on
  for (const double t_s : {2.0, 7.0, 12.0}) EXPECT_FALSE(tied(track, t_s)) << t_s;
  EXPECT_TRUE(tied(track, 5.0));
  EXPECT_FALSE(tied(track, 16.0)) << "beyond the newest keyframe";
}

}  // namespace
}  // namespace slamd
