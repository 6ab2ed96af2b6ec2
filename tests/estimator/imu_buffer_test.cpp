#include "estimator/odometry/imu_buffer.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamd {
namespace {

HostTime ms(double milliseconds) { return from_ns<HostTime>(std::llround(milliseconds * 1e6)); }

/// Values linear in time, so that interpolation and means are known exactly.
ImuSample sample_at(HostTime time) {
  const double t = to_seconds(time.time_since_epoch());
  ImuSample sample{.time = time, .arrival = time};
  sample.gyro_rads = Eigen::Vector3d{t, 2.0 * t, -t};
  sample.accel_mps2 = Eigen::Vector3d{1.0, t, 9.8};
  return sample;
}

void fill(ImuBuffer& buffer, double from_ms, double to_ms, double step_ms) {
  for (double t = from_ms; t <= to_ms + 1e-9; t += step_ms) ASSERT_TRUE(buffer.push(sample_at(ms(t))));
}

std::vector<ImuPiece> pieces_of(const ImuBuffer& buffer, HostTime from, HostTime to) {
  std::vector<ImuPiece> out;
  walk(buffer, from, to, std::chrono::milliseconds{25}, [&](const ImuPiece& piece) { out.push_back(piece); });
  return out;
}

/// The pieces follow each other without a hole or overlap from `from` to `to`.
void expect_exact_cover(const std::vector<ImuPiece>& pieces, HostTime from, HostTime to) {
  HostTime at = from;
  for (const ImuPiece& piece : pieces) {
    ASSERT_EQ(piece.from, at);
    ASSERT_GT(piece.to, piece.from);
    at = piece.to;
  }
  ASSERT_EQ(at, to);
}

TEST(ImuBuffer, KeepsTheNewestSamplesWhenItWrapsAround) {
  ImuBuffer buffer;
  constexpr int kPushed = static_cast<int>(ImuBuffer::kCapacity) * 2 + 17;
  fill(buffer, 0.0, kPushed - 1.0, 1.0);
  ASSERT_EQ(buffer.size(), ImuBuffer::kCapacity);
  EXPECT_EQ(buffer.newest().time, ms(kPushed - 1.0));
  for (std::size_t i = 1; i < buffer.size(); ++i) ASSERT_EQ(buffer[i].time - buffer[i - 1].time, ms(1.0) - ms(0.0));
}

TEST(ImuBuffer, RefusesSamplesThatAreNotYounger) {
  ImuBuffer buffer;
  EXPECT_TRUE(buffer.push(sample_at(ms(10))));
  EXPECT_FALSE(buffer.push(sample_at(ms(10))));
  EXPECT_FALSE(buffer.push(sample_at(ms(9))));
  EXPECT_EQ(buffer.size(), 1U);
  EXPECT_TRUE(buffer.push(sample_at(ms(20))));
}

TEST(ImuBuffer, DropsTheSamplesAfterATime) {
  ImuBuffer buffer;
  fill(buffer, 10, 50, 10);
  buffer.drop_after(ms(30));
  EXPECT_EQ(buffer.size(), 3U);
  EXPECT_EQ(buffer.newest().time, ms(30));
  buffer.drop_after(ms(60));
  EXPECT_EQ(buffer.size(), 3U);
  buffer.drop_after(ms(5));
  EXPECT_TRUE(buffer.empty());
}

TEST(ImuBuffer, FindsTheFirstSampleAfterATime) {
  ImuBuffer buffer;
  EXPECT_EQ(buffer.first_after(ms(0)), 0U);
  fill(buffer, 10, 50, 10);
  EXPECT_EQ(buffer.first_after(ms(5)), 0U);
  EXPECT_EQ(buffer.first_after(ms(10)), 1U);
  EXPECT_EQ(buffer.first_after(ms(39.9)), 3U);
  EXPECT_EQ(buffer.first_after(ms(50)), 5U);
}

TEST(ImuBuffer, InterpolatesBetweenSamplesAndHoldsOutsideOfThem) {
  ImuBuffer buffer;
  fill(buffer, 10, 50, 10);
  EXPECT_LT((buffer.at(ms(33)).gyro_rads - sample_at(ms(33)).gyro_rads).norm(), 1e-15);
  EXPECT_EQ(buffer.at(ms(30)).accel_mps2, sample_at(ms(30)).accel_mps2);
  EXPECT_EQ(buffer.at(ms(0)).gyro_rads, sample_at(ms(10)).gyro_rads);
  EXPECT_EQ(buffer.at(ms(99)).gyro_rads, sample_at(ms(50)).gyro_rads);
}

TEST(ImuBuffer, ClearForgetsEverything) {
  ImuBuffer buffer;
  fill(buffer, 10, 50, 10);
  buffer.clear();
  EXPECT_TRUE(buffer.empty());
  EXPECT_TRUE(buffer.push(sample_at(ms(1))));
}

TEST(ImuWalk, PiecesEndAtSamplesAndCoverTheIntervalExactly) {
  ImuBuffer buffer;
  fill(buffer, 0, 100, 5);
  const std::vector<ImuPiece> pieces = pieces_of(buffer, ms(12), ms(33));
  expect_exact_cover(pieces, ms(12), ms(33));
  ASSERT_EQ(pieces.size(), 5U);  // 12 15 20 25 30 33
  for (const ImuPiece& piece : pieces) {
    EXPECT_TRUE(piece.measured);
    const HostTime middle = piece.from + (piece.to - piece.from) / 2;
    EXPECT_LT((piece.gyro_rads - sample_at(middle).gyro_rads).norm(), 1e-12);
    EXPECT_LT((piece.accel_mps2 - sample_at(middle).accel_mps2).norm(), 1e-12);
  }
}

TEST(ImuWalk, ConsecutiveWalksEqualOneWalk) {
  ImuBuffer buffer;
  fill(buffer, 0, 100, 5);
  Eigen::Vector3d whole = Eigen::Vector3d::Zero(), parts = Eigen::Vector3d::Zero();
  const auto integrate = [](Eigen::Vector3d& sum) {
    return [&sum](const ImuPiece& piece) { sum += to_seconds(piece.to - piece.from) * piece.gyro_rads; };
  };
  const Duration max_gap = std::chrono::milliseconds{25};
  walk(buffer, ms(3), ms(91), max_gap, integrate(whole));
  for (const auto& [from, to] : {std::pair{3.0, 20.0}, {20.0, 21.7}, {21.7, 91.0}})
    walk(buffer, ms(from), ms(to), max_gap, integrate(parts));
  EXPECT_LT((whole - parts).norm(), 1e-15);
  EXPECT_NEAR(whole.x(), 0.5 * (0.091 * 0.091 - 0.003 * 0.003), 1e-12);
}

TEST(ImuWalk, AGapIsCoveredByShortPiecesWithoutMeasurement) {
  ImuBuffer buffer;
  fill(buffer, 0, 50, 5);
  fill(buffer, 150, 200, 5);
  const std::vector<ImuPiece> pieces = pieces_of(buffer, ms(40), ms(160));
  expect_exact_cover(pieces, ms(40), ms(160));
  for (const ImuPiece& piece : pieces) {
    const bool in_gap = piece.from >= ms(50) && piece.to <= ms(150);
    EXPECT_EQ(piece.measured, !in_gap);
    if (in_gap) {
      EXPECT_LE(to_seconds(piece.to - piece.from), 0.0101);
    }
  }
}

TEST(ImuWalk, OneOrTwoLostSamplesAreBridgedByInterpolation) {
  ImuBuffer buffer;
  fill(buffer, 0, 50, 5);
  fill(buffer, 65, 100, 5);
  const std::vector<ImuPiece> pieces = pieces_of(buffer, ms(40), ms(80));
  expect_exact_cover(pieces, ms(40), ms(80));
  for (const ImuPiece& piece : pieces) EXPECT_TRUE(piece.measured);
}

TEST(ImuWalk, WithoutSamplesNothingIsMeasured) {
  const ImuBuffer buffer;
  const std::vector<ImuPiece> pieces = pieces_of(buffer, ms(0), ms(35));
  expect_exact_cover(pieces, ms(0), ms(35));
  for (const ImuPiece& piece : pieces) EXPECT_FALSE(piece.measured);
}

TEST(ImuWalk, TimeBeforeTheFirstSampleIsNotMeasured) {
  ImuBuffer buffer;
  fill(buffer, 100, 200, 5);
  const std::vector<ImuPiece> pieces = pieces_of(buffer, ms(80), ms(110));
  expect_exact_cover(pieces, ms(80), ms(110));
  for (const ImuPiece& piece : pieces) EXPECT_EQ(piece.measured, piece.from >= ms(100));
}

TEST(ImuWalk, TheNewestSampleHoldsForAShortTimeAndNotForALongOne) {
  ImuBuffer buffer;
  fill(buffer, 0, 50, 5);
  for (const ImuPiece& piece : pieces_of(buffer, ms(50), ms(60))) {
    EXPECT_TRUE(piece.measured);
    EXPECT_EQ(piece.gyro_rads, sample_at(ms(50)).gyro_rads);
  }
  const std::vector<ImuPiece> late = pieces_of(buffer, ms(50), ms(120));
  expect_exact_cover(late, ms(50), ms(120));
  EXPECT_FALSE(late.back().measured);
}

TEST(ImuWalk, AnEmptyIntervalHasNoPiece) {
  ImuBuffer buffer;
  fill(buffer, 0, 50, 5);
  EXPECT_TRUE(pieces_of(buffer, ms(20), ms(20)).empty());
  EXPECT_TRUE(pieces_of(buffer, ms(30), ms(20)).empty());
}

TEST(ImuWalk, ClippingIsReportedWithThePiecesItTouches) {
  ImuBuffer buffer;
  for (int i = 0; i <= 10; ++i) {
    ImuSample sample = sample_at(ms(5.0 * i));
    sample.clipped = i == 4;  // at 20 ms
    ASSERT_TRUE(buffer.push(sample));
  }
  for (const ImuPiece& piece : pieces_of(buffer, ms(2), ms(50))) {
    const bool touches = piece.from <= ms(20) && piece.to >= ms(20);
    EXPECT_EQ(piece.clipped, touches) << "from " << to_seconds(piece.from - ms(0)) << " s";
  }
}

}  // namespace
}  // namespace slamd
