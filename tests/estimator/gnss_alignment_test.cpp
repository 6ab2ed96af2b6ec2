#include "estimator/graph/gnss_alignment.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "tests/support/random_states.hpp"

namespace slamd {
namespace {

using test::Random;

const Eigen::Vector3d kAntenna{-0.6, 0.35, 1.74};
constexpr double kSpeed_mps = 8.0;
constexpr double kYaw_rad = 1.1;  // of map in ENU
const Eigen::Vector3d kShift_m{20.0, -35.0, 4.0};

HostTime at(double s) { return HostTime{from_seconds(s)}; }

/// A figure of eight, 8 m/s, its lobes 90 m wide.
Pose T_map_base(double t_s) {
  const double radius_m = 45.0;
  const double lap = 2.0 * std::numbers::pi * radius_m;
  const double along = std::fmod(kSpeed_mps * t_s, 2.0 * lap);
  const double side = along < lap ? 1.0 : -1.0;
  const double angle = std::fmod(along, lap) / radius_m;
  const Eigen::Vector3d p{radius_m * std::sin(angle), side * radius_m * (1.0 - std::cos(angle)), 0.02 * along};
  return {Eigen::Quaterniond{Eigen::AngleAxisd{side * angle, Eigen::Vector3d::UnitZ()}}, p};
}

/// The drive, its fixes, and what is done to them.
struct Drive {
  double seconds = 140.0;
  double extra_latency_s = 0.0;
  double bend_rad_m = 0.0;  // odometry's own drift of heading
  double sigma_m = 1.0;     // claimed
  double period_s = 1.0;    // of the fixes
  bool with_velocity = false;
  std::function<bool(double t_s, Eigen::Vector3d& p_enu, GnssFix& fix)> fault = [](double, Eigen::Vector3d&, GnssFix&) {
    return true;
  };
};

struct Outcome {
  GnssAlignment alignment{{}, kAntenna};
  OdometryChain chain;
  std::vector<KeyframeEstimate> keyframes;
  int changes = 0;

  GraphView view() const { return {keyframes, chain}; }
  int count(FixVerdict verdict) const {
    return static_cast<int>(std::ranges::count(alignment.reports(), verdict, &FixReport::verdict));
  }
};

/// Errors of a receiver: 0.7 m for half a minute, 0.3 m white.
struct ReceiverError {
  Random random;
  Eigen::Vector3d slow = Eigen::Vector3d::Zero();
  explicit ReceiverError(std::uint64_t seed) : random{seed} { slow = test::normal3(random, 0.7); }
  Eigen::Vector3d next() {
    const double decay = std::exp(-1.0 / 30.0);
    slow = decay * slow + std::sqrt(1.0 - decay * decay) * test::normal3(random, 0.7);
    return slow + test::normal3(random, 0.3);
  }
};

/// Of the antenna in ENU, with the receiver's noise, as course and speed.
void tell_velocity(double t_s, Random& random, GnssFix& fix) {
  const Eigen::Vector3d step = T_map_base(t_s + 0.01) * kAntenna - T_map_base(t_s - 0.01) * kAntenna;
  const Eigen::Vector3d v = exp_so3({0.0, 0.0, kYaw_rad}) * step / 0.02 + test::normal3(random, 0.1);
  fix.velocity_valid = true;
  fix.speed_mps = v.head<2>().norm();
  fix.course_deg = std::atan2(v.x(), v.y()) * 180.0 / std::numbers::pi;
}

void drive(const Drive& drive, std::uint64_t seed, Outcome& outcome) {
  const LocalEnu enu{{48.0, 11.0, 500.0}};
  ReceiverError error{seed};
  Random velocity_error{seed};
  double next_fix_s = 1.0;
  Pose T_odom_base = T_map_base(0.0);
  for (std::size_t i = 0; 1.5 * static_cast<double>(i) < kSpeed_mps * drive.seconds; ++i) {
    const double t = 1.5 * static_cast<double>(i) / kSpeed_mps;
    if (i > 0) T_odom_base = T_odom_base * T_map_base(t - 1.5 / kSpeed_mps).inverse() * T_map_base(t);
    T_odom_base.rotation = T_odom_base.rotation * exp_so3({0.0, 0.0, 1.5 * drive.bend_rad_m});
    Keyframe keyframe;
    keyframe.id = i;
    keyframe.state.time = at(t);
    keyframe.state.T_odom_base = T_odom_base;
    keyframe.state.velocity_mps = T_odom_base.rotation * Eigen::Vector3d{kSpeed_mps, 0.0, 0.0};
    keyframe.relative_covariance = 1e-6 * Matrix6d::Identity();
    outcome.chain.add(T_odom_base, keyframe.relative_covariance);
    outcome.keyframes.push_back({keyframe.state.time, T_odom_base, T_odom_base});
    outcome.alignment.add(keyframe);
    for (; next_fix_s < t; next_fix_s += drive.period_s) {
      Eigen::Vector3d p_enu = exp_so3({0.0, 0.0, kYaw_rad}) * (T_map_base(next_fix_s - drive.extra_latency_s) * kAntenna) +
                              kShift_m + error.next();
      GnssFix fix;
      fix.time = fix.arrival = at(next_fix_s);
      fix.quality = GnssQuality::kAutonomous;
      fix.height_valid = true;
      fix.sigma_horizontal_m = drive.sigma_m;
      fix.sigma_vertical_m = 1.8 * drive.sigma_m;
      if (drive.with_velocity) tell_velocity(next_fix_s - drive.extra_latency_s, velocity_error, fix);
      if (!drive.fault(next_fix_s, p_enu, fix)) continue;
      const GeodeticPosition position = enu.to_geodetic(p_enu);
      fix.latitude_deg = position.latitude_deg;
      fix.longitude_deg = position.longitude_deg;
      fix.height_m = position.height_m;
      outcome.alignment.add(fix);
    }
    outcome.changes += outcome.alignment.update(outcome.view(), std::nullopt) ? 1 : 0;
  }
}

/// Largest distance between where the antenna was in ENU and where alignment and map have it, horizontally.
double worst_m(const Outcome& outcome) {
  const LocalEnu truth{{48.0, 11.0, 500.0}};
  const EnuOrigin origin = outcome.alignment.origin();
  const Eigen::Vector3d p_truth_origin =
      truth.to_enu({origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m});
  double worst = 0.0;
  for (double t = 0.0; t < 140.0; t += 5.0) {
    const Eigen::Vector3d true_enu = exp_so3({0.0, 0.0, kYaw_rad}) * T_map_base(t).translation + kShift_m;
    const Eigen::Vector3d ours =
        outcome.alignment.initial_alignment()->T_enu_map() * T_map_base(t).translation + p_truth_origin;
    worst = std::max(worst, (true_enu - ours).head<2>().norm());
  }
  return worst;
}

TEST(GnssAlignment, FindsYawAndShiftFromMotionAndLeavesAGoodTrackAlone) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Outcome outcome;
    drive({}, seed, outcome);
    ASSERT_TRUE(outcome.alignment.initial_alignment());
    EXPECT_LT(worst_m(outcome), 2.0) << seed;
    EXPECT_TRUE(outcome.alignment.positions().empty()) << seed;
    EXPECT_GT(outcome.count(FixVerdict::kAccepted), 100) << seed;
  }
}

TEST(GnssAlignment, AParkedVehicleDoesNotFillTheMemory) {
  Outcome outcome;
  drive({.seconds = 30.0}, 1, outcome);
  GnssFix fix;
  fix.quality = GnssQuality::kNone;
  const auto park = [&](int fixes) {
    for (int i = 0; i < fixes; ++i) outcome.alignment.add(fix);
    return outcome.alignment.bytes();
  };
  const std::size_t full = park(110'000);
  EXPECT_EQ(park(50'000), full);
  const std::vector<FixReport> reports = outcome.alignment.reports();
  EXPECT_EQ(reports.back().number, 160'000U + 28U);
  EXPECT_TRUE(std::ranges::is_sorted(reports, {}, &FixReport::number));
}

TEST(GnssAlignment, ItsCovarianceCoversItsError) {
  double nees = 0.0;
  constexpr int kRuns = 20;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Outcome outcome;
    drive({}, seed, outcome);
    const EnuAlignment alignment = *outcome.alignment.initial_alignment();
    const double yaw_error = std::remainder(alignment.yaw_rad - kYaw_rad, 2.0 * std::numbers::pi);
    nees += yaw_error * yaw_error / alignment.covariance(3, 3) / kRuns;
  }
  EXPECT_LT(nees, 2.0);
  EXPECT_GT(nees, 0.02);  // wide: errors that last are taken as if the vehicle had not turned meanwhile
}

TEST(GnssAlignment, ABentTrackIsToldFromNoiseAndGetsPositions) {
  Outcome outcome;
  drive({.bend_rad_m = 4e-4}, 3, outcome);
  EXPECT_GT(outcome.alignment.positions().size(), 10U);
  for (const GnssPosition& position : outcome.alignment.positions()) EXPECT_GT(position.sigma_m.x(), 2.0);
}

TEST(GnssAlignment, ExtraLatencyIsFoundWithItsSigma) {
  Outcome outcome;
  drive({.seconds = 600.0, .extra_latency_s = 0.4}, 4, outcome);
  const GnssLatency latency = outcome.alignment.latency();
  EXPECT_NEAR(latency.correction_s, 0.4, 0.12);
  EXPECT_LT(latency.sigma_s, 0.1);
}

TEST(GnssAlignment, TheReceiversVelocityTellsTheLatencyToHundredths) {
  double nees = 0.0;
  constexpr int kRuns = 6;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Outcome outcome;
    drive({.seconds = 300.0, .extra_latency_s = 0.12, .with_velocity = true}, seed, outcome);
    const GnssLatency latency = outcome.alignment.latency();
    EXPECT_NEAR(latency.correction_s, 0.12, 0.03) << seed;
    EXPECT_LT(latency.sigma_s, 0.02) << seed;
    nees += std::pow((latency.correction_s - 0.12) / latency.sigma_s, 2) / kRuns;
  }
  EXPECT_LT(nees, 2.1);
}

TEST(GnssAlignment, MoreFixesASecondDoNotMakeItSurer) {
  Outcome slow, fast;
  drive({}, 5, slow);
  drive({.period_s = 0.2}, 5, fast);
  const double slow_sigma = std::sqrt(slow.alignment.initial_alignment()->covariance(3, 3));
  EXPECT_NEAR(std::sqrt(fast.alignment.initial_alignment()->covariance(3, 3)), slow_sigma, 0.1 * slow_sigma);
}

TEST(GnssAlignment, AtRestNothingIsTied) {
  Outcome outcome;
  drive({.seconds = 0.4}, 1, outcome);
  EXPECT_FALSE(outcome.alignment.initial_alignment());
}

/// The failure verbs of a source, each from 60 s on: the alignment stays, and what is wrong is refused.
struct FaultCase {
  const char* verb;
  std::function<bool(double, Eigen::Vector3d&, GnssFix&)> fault;
  int most_accepted_after;  // of the fixes from 60 s on
};

void PrintTo(const FaultCase& fault, std::ostream* out) { *out << fault.verb; }

class GnssFault : public testing::TestWithParam<FaultCase> {};

TEST_P(GnssFault, DoesNotMoveTheAlignmentNorBendTheTrack) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Outcome outcome;
    drive({.fault = GetParam().fault}, seed, outcome);
    ASSERT_TRUE(outcome.alignment.initial_alignment());
    EXPECT_LT(worst_m(outcome), 2.0) << seed;
    EXPECT_TRUE(outcome.alignment.positions().empty()) << seed;
    int accepted = 0;
    for (const FixReport& report : outcome.alignment.reports()) {
      accepted += report.time >= at(60.0) && report.verdict == FixVerdict::kAccepted ? 1 : 0;
    }
    EXPECT_LE(accepted, GetParam().most_accepted_after) << seed;
  }
}

std::vector<FaultCase> failure_verbs() {
  using P = Eigen::Vector3d;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  Random random{1};
  const auto stuck = [held](double t, P& p, GnssFix&) mutable {
    if (t < 60.0) held = p;
    p = held;
    return true;
  };
  const auto garbage = [random](double t, P& p, GnssFix&) mutable {
    if (t >= 60.0) p = test::normal3(random, 500.0);
    return true;
  };
  const auto delayed = [](double t, P& p, GnssFix&) {
    if (t >= 60.0) p = exp_so3({0.0, 0.0, kYaw_rad}) * (T_map_base(t - 2.0) * kAntenna) + kShift_m;
    return true;
  };
  const auto weak = [](double t, P&, GnssFix& fix) {
    if (t >= 60.0) fix.sigma_horizontal_m = 20.0;
    return true;
  };
  /// 30 m beside the truth while when(t).
  const auto wrong = [](auto when) {
    return [when](double t, P& p, GnssFix&) {
      if (t >= 60.0 && when(t)) p.x() += 30.0;
      return true;
    };
  };
  return {{"off", [](double t, P&, GnssFix&) { return t < 60.0; }, 0},
          {"stuck", stuck, 12},
          {"garbage", garbage, 3},
          {"wrong", wrong([](double) { return true; }), 0},
          {"multipath", wrong([](double t) { return t < 80.0; }), 60},
          {"slow", [](double t, P&, GnssFix&) { return t < 60.0 || static_cast<int>(t) % 5 == 0; }, 20},
          {"delayed", delayed, 3},
          {"weak", weak, 0},
          {"intermittent", wrong([](double t) { return static_cast<int>(t) % 4 < 2; }), 45}};
}

INSTANTIATE_TEST_SUITE_P(Verbs, GnssFault, testing::ValuesIn(failure_verbs()),
                         [](const auto& verb) { return std::string{verb.param.verb}; });

TEST(GnssAlignment, FixesThatAreNoNumberAreRefused) {
  Outcome outcome;
  GnssFix fix;
  fix.time = at(1.0);
  fix.quality = GnssQuality::kAutonomous;
  fix.sigma_horizontal_m = 1.0;
  fix.latitude_deg = std::numeric_limits<double>::quiet_NaN();
  outcome.alignment.add(fix);
  EXPECT_EQ(outcome.count(FixVerdict::kQuality), 1);
}

}  // namespace
}  // namespace slamd
