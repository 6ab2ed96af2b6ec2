#pragma once
// A running server on a socket in a folder of its own, with stores that a test fills. No estimator behind it.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "daemon/server/server.hpp"
#include "tests/support/raw_client.hpp"

namespace slamd::test {

class ServerTest : public testing::Test {
 protected:
  static std::string make_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "slamd_server_XXXXXX").string();
    return ::mkdtemp(pattern.data());
  }

  ~ServerTest() override {
    if (server_) server_->stop();
    std::filesystem::remove_all(folder_);
  }

  void start(ServerLimits limits = {}) {
    server_ = std::make_unique<Server>(config(limits), sources(), "1.2.3");
    const Result<void> started = server_->start();
    ASSERT_TRUE(started) << started.reason();
  }

  ServerConfig config(ServerLimits limits = {}) const {
    return {.socket_path = socket_path(), .save_dir = folder_, .control_group = {}, .limits = limits};
  }
  ServerSources sources() {
    return {.pose = publisher_, .map = map_, .trajectory = trajectory_, .health = health_, .faults = faults_, .dump = {}, .grid = grid_};
  }
  std::string socket_path() const { return folder_ + "/slamd.sock"; }
  RawClient connect() const { return RawClient{socket_path()}; }

  void publish(std::int64_t time_ns, TrackingStatus status = TrackingStatus::kTracking, std::uint32_t reasons = 0) {
    NavState state;
    state.time = from_ns<HostTime>(time_ns);
    state.T_odom_base.translation = {static_cast<double>(time_ns) * 1e-9, 2.0, 3.0};
    state.status = status;
    state.reasons = reasons;
    state.covariance = Matrix6d::Identity() * 0.25;
    publisher_.publish(state);
  }
  void add_keyframe(std::uint64_t id, std::size_t points) {
    Keyframe keyframe;
    keyframe.id = id;
    for (std::size_t i = 0; i < points; ++i) {
      keyframe.points.push_back({static_cast<float>(i % 100), static_cast<float>(i / 100), 1.0F, 7.0F});
    }
    map_.add(keyframe);
  }
  /// get_status until the server's count has that value; the count itself if it never does.
  std::uint64_t wait_for_count(const std::string& name, std::uint64_t value) {
    RawClient client = connect();
    std::uint64_t count = 0;
    for (int i = 0; i < 2000; ++i) {
      count = client.call(i, "get_status").at("result").at("server").at(name).get<std::uint64_t>();
      if (count == value) break;
      ::usleep(10'000);  // between polls only; the condition decides
    }
    return count;
  }

  std::string folder_ = make_folder();
  PosePublisher publisher_ = PosePublisher::create().value();
  MapStore map_;
  TrajectoryStore trajectory_;
  HealthBoard health_{HostTime{}};
  FaultBoard* faults_ = nullptr;
  const GridStore* grid_ = nullptr;
  std::unique_ptr<Server> server_;
};

}  // namespace slamd::test
