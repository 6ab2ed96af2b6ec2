// The planar mapping thread without its thread's other ends: keyframes in, grids and checkpoints out, and a map of before gone on in.

#include "daemon/threads/planar_mapping_thread.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/pause.hpp"
#include "daemon/threads/planar_front_end.hpp"
#include "daemon/threads/worker.hpp"

namespace slamd {
namespace {

/// What a LiDAR at `T` sees of an L-shaped hall of 12 m x 9 m: its walls, a point every 5 cm.
std::vector<Eigen::Vector2f> seen_from(const PlanarPose& T) {
  const std::vector<Eigen::Vector2d> corners{{-5, -4}, {7, -4}, {7, 1}, {2, 1}, {2, 5}, {-5, 5}, {-5, -4}};
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d way = corners[i + 1] - corners[i];
    for (double at = 0.0; at < way.norm(); at += 0.05) {
      points.push_back((T.inverse().translation + T.rotation().transpose() * (corners[i] + way.normalized() * at)).cast<float>());
    }
  }
  return points;
}

PlanarKeyframe keyframe_at(const PlanarPose& T_odom_base, const PlanarPose& T_hall_odom = {}) {
  static std::int64_t time_ns = 1'000'000'000'000;
  PlanarKeyframe keyframe;
  keyframe.T_odom_base = T_odom_base;
  keyframe.relative_covariance = keyframe.match_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  keyframe.scan.time = from_ns<HostTime>(time_ns += 100'000'000);
  keyframe.scan.points = seen_from(T_hall_odom * T_odom_base);
  return keyframe;
}

class PlanarMapping : public testing::Test {
 protected:
  PlanarMapping() { std::filesystem::create_directories(folder_); }
  ~PlanarMapping() override { std::filesystem::remove_all(folder_); }

  struct Run {
    std::unique_ptr<Streams> streams = std::make_unique<Streams>();
    GridStore grid;
    TrajectoryStore trajectory;
    std::unique_ptr<PlanarMappingThread> thread;
  };
  CheckpointConfig checkpoint() const { return {.folder = folder_, .period = std::chrono::hours{1}}; }
  std::unique_ptr<Run> make() const {
    auto run = std::make_unique<Run>();
    run->thread = std::make_unique<PlanarMappingThread>(Slam2dConfig{}, PlanarKeeper{checkpoint(), {}}, *run->streams, run->grid, run->trajectory);
    return run;
  }
  /// Until everything that waits has been taken and a grid of it made.
  static void work(Run& run) {
    const Worker worker{{"mapping"}, [&](const std::stop_token& stop) { run.thread->run(stop); }};
    while (run.streams->planar_keyframes.counts().size > 0) pause_for(std::chrono::milliseconds{5});
    while (run.thread->state().grid_keyframes < run.thread->state().keyframes || run.grid.newest().grid == nullptr) pause_for(std::chrono::milliseconds{5});
  }

  std::string folder_ = testing::TempDir() + "planar_mapping_" + std::to_string(::getpid());
};

std::int8_t cell(const OccupancyGrid& grid, double x, double y) {
  const auto column = static_cast<std::size_t>((x - grid.origin.x()) / grid.resolution_m);
  const auto row = static_cast<std::size_t>((y - grid.origin.y()) / grid.resolution_m);
  return grid.cells.at(row * grid.width + column);
}

TEST_F(PlanarMapping, KeyframesBecomeAGridAndAFile) {
  const auto run = make();
  for (int i = 0; i < 8; ++i) run->streams->planar_keyframes.try_push(keyframe_at({{0.25 * i, 0.0}, 0.0}));
  work(*run);
  const GridStore::Newest newest = run->grid.newest();
  EXPECT_EQ(cell(*newest.grid, 7.01, -1.5), kOccupiedCell);
  EXPECT_EQ(cell(*newest.grid, 3.0, -1.0), kFreeCell);
  const PlanarState state = run->thread->state();
  EXPECT_EQ(state.keyframes, 8U);
  EXPECT_FALSE(state.relocalising);
  const Result<StoredPlanarMap> kept = load_planar_checkpoint(planar_checkpoint_path(checkpoint()), {});
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->size(), 8U);
  EXPECT_NEAR(kept->back().pose.x(), 1.75, 1e-9);
}

TEST_F(PlanarMapping, AVehicleThatIsStillThereGoesOnInTheMapOfBefore) {
  const auto before = make();
  for (int i = 0; i < 8; ++i) before->streams->planar_keyframes.try_push(keyframe_at({{0.25 * i, 0.0}, 0.0}));
  work(*before);
  // The next process begins its odom half a metre on, turned a little.
  const PlanarPose T_hall_odom{{2.2, 0.3}, 0.2};
  const auto after = make();
  after->thread->restore(*load_planar_checkpoint(planar_checkpoint_path(checkpoint()), {}));
  EXPECT_FALSE(after->streams->map_link.load()->known) << "until it has been found";
  for (int i = 0; i < 4; ++i) after->streams->planar_keyframes.try_push(keyframe_at({{0.25 * i, 0.0}, 0.0}, T_hall_odom));
  work(*after);
  const PlanarState state = after->thread->state();
  EXPECT_EQ(state.relocalisation.relocalised, 1U);
  EXPECT_EQ(state.keyframes, 12U) << "those of before among them";
  const MapLink* link = after->streams->map_link.load();
  ASSERT_NE(link, nullptr);
  EXPECT_TRUE(link->known);
  EXPECT_LT((link->T_map_odom.translation - Eigen::Vector3d(2.2, 0.3, 0.0)).norm(), 0.04);
  EXPECT_EQ(load_planar_checkpoint(planar_checkpoint_path(checkpoint()), {})->size(), 12U);
}

TEST_F(PlanarMapping, AVehicleThatIsElsewhereBeginsAnewAndSaysSo) {
  const auto before = make();
  for (int i = 0; i < 8; ++i) before->streams->planar_keyframes.try_push(keyframe_at({{0.25 * i, 0.0}, 0.0}));
  work(*before);
  const auto after = make();
  after->thread->restore(*load_planar_checkpoint(planar_checkpoint_path(checkpoint()), {}));
  for (int i = 0; i < 30; ++i) {  // a narrow corridor at an angle that the hall has nowhere
    PlanarKeyframe keyframe = keyframe_at({{0.25 * i, 0.0}, 0.0});
    keyframe.scan.points.clear();
    for (float x = -3.0F; x < 3.0F; x += 0.05F) {
      keyframe.scan.points.emplace_back(x, 0.8F + 0.5F * x);
      keyframe.scan.points.emplace_back(x, -0.8F + 0.1F * x * x);
    }
    after->streams->planar_keyframes.try_push(keyframe);
  }
  work(*after);
  const PlanarState state = after->thread->state();
  EXPECT_EQ(state.relocalisation.begun_anew, 1U);
  EXPECT_EQ(state.keyframes, 30U) << "none of the old map";
  EXPECT_TRUE(after->streams->map_link.load()->known);
}

TEST_F(PlanarMapping, AFolderThatTakesNoFileIsTold) {
  auto run = std::make_unique<Run>();
  run->thread = std::make_unique<PlanarMappingThread>(Slam2dConfig{}, PlanarKeeper{{.folder = "/proc"}, {}}, *run->streams, run->grid, run->trajectory);
  run->streams->planar_keyframes.try_push(keyframe_at({}));
  work(*run);
  EXPECT_EQ(run->thread->state().checkpoint.state, "failed");
  EXPECT_NE(run->thread->state().checkpoint.reason, "");
}

TEST(PlanarFrontEndSnapshot, IsTheSameMotionSeenFromTheImu) {
  VehicleGeometry vehicle;
  vehicle.T_base_imu = {Eigen::Quaterniond{Eigen::AngleAxisd{1.0, Eigen::Vector3d(1, 2, 3).normalized()}}, {0.3, -0.2, 1.0}};
  NavState state;
  state.time = from_ns<HostTime>(5);
  state.T_odom_base = {Eigen::Quaterniond{Eigen::AngleAxisd{0.7, Eigen::Vector3d::UnitZ()}}, {4.0, 5.0, 0.0}};
  state.velocity_mps = {1.0, 0.5, 0.0};
  state.angular_velocity_rads = {0.0, 0.0, 0.4};
  state.covariance = Matrix6d::Identity() * 0.01;
  const FilterSnapshot snapshot = snapshot_of(state, vehicle, 0.1);
  const Pose T_odom_base = snapshot.state.T_odom_imu() * vehicle.T_base_imu.inverse();
  EXPECT_LT((T_odom_base.translation - state.T_odom_base.translation).norm(), 1e-12);
  constexpr double kStep = 1e-6;  // the IMU's place a moment later, by the motion of base
  const Pose later{state.T_odom_base.rotation * Eigen::Quaterniond{Eigen::AngleAxisd{0.4 * kStep, Eigen::Vector3d::UnitZ()}},
                   state.T_odom_base.translation + kStep * state.velocity_mps};
  const Eigen::Vector3d velocity = ((later * vehicle.T_base_imu).translation - snapshot.state.p_odom_imu) / kStep;
  EXPECT_LT((velocity - snapshot.state.v_odom_imu).norm(), 1e-5);
  EXPECT_NEAR(snapshot.angular_velocity_rads.norm(), 0.4, 1e-12);
}

}  // namespace
}  // namespace slamd
