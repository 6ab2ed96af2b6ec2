#include "estimator/graph/loop_closer.hpp"

#include <gtest/gtest.h>

#include "tests/support/box_town.hpp"

namespace slamd {
namespace {

using test::BoxTown;
using test::kRoadRadius_m;
using test::kRoadSpacing_m;
using test::Random;


/// Rather more than a lap around the town, with odometry that drifts as its covariance says.
struct Lap {
  std::vector<Keyframe> keyframes;
  std::vector<Pose> truth;
  OdometryChain chain;
  std::vector<KeyframeEstimate> estimates;

  /// jump_m  of odometry in the middle of the lap, known to it by its covariance alone
  explicit Lap(std::uint64_t seed, double jump_m = 0.0) {
    const BoxTown town = BoxTown::around_circle(kRoadRadius_m, 7);
    Random random{seed};
    Pose T_odom_base;
    for (std::size_t i = 0; i < 160; ++i) {
      const double along_m = kRoadSpacing_m * static_cast<double>(i);
      truth.push_back(test::pose_on_circle(kRoadRadius_m, along_m, i > 110 ? 1.0 : 0.0));
      Vector6d sigma = Vector6d::Constant(2e-4);
      sigma.head<3>().setConstant(4e-3);
      if (i == 60) sigma.head<2>().setConstant(std::max(4e-3, jump_m));
      if (i > 0) {
        Vector6d e = i == 60 ? Vector6d{Vector6d::Zero()} : Vector6d{sigma};
        for (int k = 0; k < 6; ++k) e[k] *= test::normal(random, 1.0);
        if (i == 60) e.head<2>() << jump_m * 0.8, jump_m * 0.6;
        T_odom_base = T_odom_base * boxplus(truth[i - 1].inverse() * truth[i], e);
      } else {
        T_odom_base = truth[0];
      }
      Keyframe keyframe;
      keyframe.id = i;
      keyframe.state.T_odom_base = T_odom_base;
      keyframe.relative_covariance = sigma.cwiseAbs2().asDiagonal();
      keyframe.points = town.scan(truth[i], random);
      chain.add(T_odom_base, keyframe.relative_covariance);
      estimates.push_back({keyframe.state.time, T_odom_base, T_odom_base});
      keyframes.push_back(std::move(keyframe));
    }
  }

  GraphView view() const { return {estimates, chain}; }
  double error_m(const LoopClosure& c) const {
    return boxminus(truth[c.from].inverse() * truth[c.to], c.T_from_to).head<3>().norm();
  }
};

/// The odometry of these tests has no map: it holds no place.
LoopCloserConfig nothing_held() {
  LoopCloserConfig config;
  config.local_map_reach_m = 1.0;
  return config;
}

LoopCloser run(const Lap& lap, const LoopCloserConfig& config = nothing_held()) {
  LoopCloser closer{config, test::kLidarInBase};
  for (const Keyframe& keyframe : lap.keyframes) closer.add(keyframe);
  closer.update(lap.view());
  return closer;
}

TEST(LoopCloser, ASearchThatIsCancelledAtEveryKeyframeFindsTheSameInTheEnd) {
  const Lap lap{3};
  const LoopCloser whole = run(lap);
  LoopCloser closer{nothing_held(), test::kLidarInBase};
  for (const Keyframe& keyframe : lap.keyframes) closer.add(keyframe);
  int updates = 0;
  for (std::size_t before = 1; before != closer.reports().size() || updates < 100; ++updates) {
    before = closer.reports().size();
    closer.update(lap.view(), [] { return true; });
  }
  ASSERT_FALSE(whole.closures().empty());
  ASSERT_EQ(closer.closures().size(), whole.closures().size());
  for (std::size_t i = 0; i < whole.closures().size(); ++i) {
    EXPECT_EQ(closer.closures()[i].from, whole.closures()[i].from);
    EXPECT_EQ(closer.closures()[i].to, whole.closures()[i].to);
  }
}

TEST(LoopCloser, ClosesTheLapWithinCentimetres) {
  const Lap lap{1};
  const LoopCloser closer = run(lap);
  ASSERT_GT(closer.closures().size(), 5U);
  for (const LoopClosure& closure : closer.closures()) {
    EXPECT_LT(lap.error_m(closure), 0.06) << closure.from << " " << closure.to;
    EXPECT_GE(closure.to, closure.from + 8);
  }
}

TEST(LoopCloser, TheFirstPlaceIsJoinedInTheMiddleOfItsSubmap) {
  const Lap lap{1};
  LoopCloserConfig config = nothing_held();
  config.keyframes_behind = 6;
  const LoopCloser closer = run(lap, config);
  const auto looked_from = [](const LoopCandidateReport& r) { return r.from == 0 && r.ended_at == LoopStage::kAccepted; };
  ASSERT_TRUE(std::ranges::any_of(closer.reports(), looked_from));
  std::uint64_t first = lap.truth.size();
  for (const LoopClosure& closure : closer.closures()) first = std::min(first, closure.from);
  EXPECT_EQ(first, 3U);  // keyframes 0 to 6
}

TEST(LoopCloser, LeavesAPlaceThatTheOdometryStillHoldsToTheOdometry) {
  LoopCloserConfig config;
  config.local_map_reach_m = 1.5 * 2.0 * kRoadRadius_m;
  EXPECT_TRUE(run(Lap{1}, config).reports().empty());
  config.local_map_reach_m = 0.8 * 2.0 * kRoadRadius_m;
  EXPECT_GT(run(Lap{1}, config).closures().size(), 5U);
}

TEST(LoopCloser, ClosesEvenThereWhenTheOdometryLostItsWay) {
  LoopCloserConfig config;
  config.local_map_reach_m = 1.5 * 2.0 * kRoadRadius_m;
  EXPECT_GT(run(Lap{2, 3.0}, config).closures().size(), 3U);
}

TEST(LoopCloser, FindsTheLoopByItsLooksAfterAJumpOfFiftyMetres) {
  const Lap lap{2, 50.0};
  const LoopCloser closer = run(lap);
  ASSERT_GT(closer.closures().size(), 3U);
  for (const LoopClosure& closure : closer.closures()) EXPECT_LT(lap.error_m(closure), 0.06);
  EXPECT_TRUE(std::ranges::any_of(closer.reports(), [](const LoopCandidateReport& r) { return r.by_appearance; }));
}

TEST(LoopCloser, EveryWrongCandidateIsRefusedWithItsStage) {
  const Lap lap{3};
  LoopCloser closer = run(lap);
  const std::size_t closures = closer.closures().size();
  Random random{5};
  for (int i = 0; i < 40; ++i) {
    const auto from = static_cast<std::uint64_t>(test::uniform(random, 0.0, 80.0));
    const auto to = from + 20 + static_cast<std::uint64_t>(test::uniform(random, 0.0, 60.0));
    if ((lap.truth[from].translation - lap.truth[to].translation).norm() < 30.0) continue;
    const LoopStage stage = closer.try_pair(lap.view(), from, to);
    EXPECT_TRUE(stage != LoopStage::kAccepted || lap.error_m(closer.closures().back()) < 0.06);
  }
  for (const LoopClosure& closure : closer.closures()) EXPECT_LT(lap.error_m(closure), 0.1);
  EXPECT_GE(closer.closures().size(), closures);
}

TEST(LoopCloser, NoLoopOnTheFirstLap) {
  Lap lap{4};
  lap.keyframes.resize(100);  // 200 of 251 m
  LoopCloser closer{nothing_held(), test::kLidarInBase};
  for (const Keyframe& keyframe : lap.keyframes) closer.add(keyframe);
  EXPECT_FALSE(closer.update(lap.view()));
  EXPECT_TRUE(closer.closures().empty());
}

TEST(LoopCloser, AClosureThatTheGraphDoubtsTwiceIsRetracted) {
  const Lap lap{1};
  LoopCloser closer = run(lap);
  const std::size_t closures = closer.closures().size();
  std::vector<double> weights(closures, 1.0);
  weights[2] = 0.01;
  closer.weigh(weights);
  EXPECT_FALSE(closer.update(lap.view()));
  closer.weigh(weights);
  EXPECT_TRUE(closer.update(lap.view()));
  EXPECT_EQ(closer.closures().size(), closures - 1);
  const auto retracted = [](const LoopCandidateReport& r) { return r.ended_at == LoopStage::kGraph; };
  EXPECT_EQ(std::ranges::count_if(closer.reports(), retracted), 1);
}

TEST(LoopCloser, TheSameKeyframesGiveTheSameBitsHoweverTheyArrive) {
  const Lap lap{1};
  const LoopCloser at_once = run(lap);
  LoopCloser one_by_one{nothing_held(), test::kLidarInBase};
  OdometryChain chain;
  std::vector<KeyframeEstimate> estimates;
  for (std::size_t i = 0; i < lap.keyframes.size(); ++i) {
    chain.add(lap.chain.T_odom_base(i), lap.keyframes[i].relative_covariance);
    estimates.push_back(lap.estimates[i]);
    one_by_one.add(lap.keyframes[i]);
    one_by_one.update({estimates, chain});
  }
  ASSERT_EQ(at_once.closures().size(), one_by_one.closures().size());
  for (std::size_t i = 0; i < at_once.closures().size(); ++i) {
    EXPECT_EQ(at_once.closures()[i].T_from_to.translation, one_by_one.closures()[i].T_from_to.translation);
    EXPECT_EQ(at_once.closures()[i].covariance, one_by_one.closures()[i].covariance);
  }
}

}  // namespace
}  // namespace slamd
