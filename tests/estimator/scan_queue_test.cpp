#include "estimator/odometry/scan_queue.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_drive.hpp"

namespace slamd {
namespace {

using test::SpinningLidar;
using test::SyntheticDrive;

class Queue : public ::testing::Test {
 protected:
  /// Packets until the next scan waits.
  void fill() {
    do queue_.add(last_ = drive_.packet(next_++));
    while (queue_.empty());
  }
  void feed_imu_to(HostTime time) {
    while (SyntheticDrive::at(0.005 * static_cast<double>(next_imu_)) <= time) imu_.add(drive_.imu(next_imu_++));
  }

  SyntheticDrive drive_;
  ScanQueue queue_{ScanQueueConfig{}};
  ImuIntake imu_{ImuIntakeConfig{}};
  std::int64_t next_ = 0, next_imu_ = 0;
  LidarPacket last_;
};

TEST_F(Queue, AScanIsDueWhenTheImuCoversIt) {
  feed_imu_to(SyntheticDrive::at(0.05));
  fill();
  const HostTime now = last_.arrival;
  EXPECT_FALSE(queue_.is_due(imu_, now));
  feed_imu_to(now + std::chrono::milliseconds{5});
  EXPECT_TRUE(queue_.is_due(imu_, now));
  const Scan& scan = queue_.take();
  EXPECT_TRUE(scan.complete);
  EXPECT_NEAR(to_seconds(scan.end - scan.begin), 0.1, 0.002);
  EXPECT_TRUE(queue_.empty());
  EXPECT_FALSE(queue_.is_due(imu_, now));
}

TEST_F(Queue, AnImuThatIsBehindIsWaitedForUntilTheDeadline) {
  feed_imu_to(SyntheticDrive::at(0.05));
  fill();
  EXPECT_FALSE(queue_.is_due(imu_, last_.arrival + std::chrono::milliseconds{45}));
  EXPECT_TRUE(queue_.is_due(imu_, last_.arrival + std::chrono::milliseconds{55}));
}

TEST_F(Queue, AnImuThatIsAbsentIsNotWaitedFor) {
  fill();
  EXPECT_TRUE(queue_.is_due(imu_, last_.arrival));
}

TEST_F(Queue, AScanThatIsNotTakenIsOvertakenAndCounted) {
  fill();
  const std::uint64_t first = queue_.stats().finished;
  while (queue_.stats().finished == first) queue_.add(drive_.packet(next_++));
  EXPECT_EQ(queue_.stats().overtaken, 1U);
  EXPECT_NEAR(SyntheticDrive::seconds(queue_.take().end), 0.2, 0.002) << "the newer one waits";
}

TEST_F(Queue, LatencyIsTheScansLengthAndItsDeadline) {
  fill();
  EXPECT_NEAR(to_seconds(queue_.latency()), 0.15, 0.002);
}

TEST_F(Queue, PacketsFromTheFutureAreRefused) {
  LidarPacket packet = drive_.packet(0);
  packet.time += std::chrono::seconds{10};
  for (int i = 0; i < 200; ++i) queue_.add(packet);
  EXPECT_TRUE(queue_.empty());
  EXPECT_EQ(queue_.stats().packets_in_future, 200U);
  EXPECT_TRUE(queue_.is_clock_unsure(packet.arrival));
  EXPECT_FALSE(queue_.is_clock_unsure(packet.arrival + std::chrono::seconds{2}));
  fill();
  EXPECT_TRUE(queue_.take().complete);
}

TEST_F(Queue, AFrozenPictureWithNewStampsIsDropped) {
  constexpr std::int64_t kTurn = 75;  // packets, a little less than a revolution
  std::vector<LidarPacket> picture;
  for (std::int64_t i = 0; i < kTurn; ++i) picture.push_back(drive_.packet(i));
  const Duration turn = picture.back().time + picture.back().span - picture.front().time;
  for (int repeat = 0; repeat < 6; ++repeat) {
    for (LidarPacket packet : picture) {
      packet.time += repeat * turn;
      packet.arrival += repeat * turn;
      queue_.add(packet);
    }
  }
  EXPECT_EQ(queue_.stats().finished, 5U);
  EXPECT_EQ(queue_.stats().repeated, 4U);
}

}  // namespace
}  // namespace slamd
