#pragma once
// The IMU's thread: serial bytes to samples for the estimator, and each sample at once to a new pose on the pose page,
// also while a scan is being fused. Real-time; when the IMU is silent it publishes the pose all the same.

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "daemon/health/health_board.hpp"
#include "daemon/health/histogram.hpp"
#include "daemon/inject/sensor_fault.hpp"
#include "daemon/ring/latest_value.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/server/pose_publisher.hpp"
#include "daemon/threads/map_placement.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/streams.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/imu/imu_source.hpp"
#include "estimator/odometry/pose_predictor.hpp"

namespace slamd {

struct ImuThreadConfig {
  ImuSourceConfig source;
  Duration silence = std::chrono::milliseconds{20};  // without samples for so long the pose is carried on without them
};

/// What the thread has seen; totals since the start.
struct ImuReport {
  HostTime last_arrival;  // of the newest sample; only meaningful when samples > 0
  std::uint64_t samples = 0;  // handed on
  HostTime last_bytes;    // of the newest bytes, whatever they were
  ImuStats parser;
  SourceStats source;
  bool device_open = false;
  ClockHealth clock;
};

class ImuThread {
 public:
  /// streams and publisher must outlive it.
  ImuThread(const ImuThreadConfig& config, const ImuFrameParser::Config& frames, PosePredictor predictor,
            Streams& streams, PosePublisher& publisher);

  /// Before run(): every read of the port goes to `tap` as well, which must outlive the thread.
  void record_to(WireTap& tap) { tap_ = &tap; }
  /// Before run(): where the vehicle was when the map that is taken over was left.
  void begin_at(const Pose& T_map_base) { placement_ = MapPlacement{T_map_base}; }
  /// Before run(): failures may be played on this sensor.
  void allow_faults();
  /// The thread's body: returns within a tenth of a second after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  /// Reads of the port, also of a silent or absent one: food for a watchdog.
  std::uint64_t passes() const { return passes_.load(std::memory_order_relaxed); }
  ImuReport report() const { return report_.load().value_or(ImuReport{}); }
  /// Arrival of an IMU frame to its pose on the page.
  const Histogram& imu_to_page() const { return imu_to_page_; }

 private:
  void take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING;
  void take(const ImuSample& sample);
  void take_posterior() SLAMD_NONBLOCKING;
  void carry_on(HostTime now) SLAMD_NONBLOCKING;
  void publish(const NavState& state);
  void tell() SLAMD_NONBLOCKING;

  const ImuThreadConfig config_;
  std::unique_ptr<ByteSource> source_;
  ImuFrameParser parser_;
  PosePredictor predictor_;
  Streams& streams_;
  WireTap* tap_ = nullptr;
  std::unique_ptr<SensorFault<ImuValueFault>> faults_;  // null: none may be played
  PosePublisher& publisher_;
  MapPlacement placement_;
  HostTime last_posterior_;
  HostTime last_published_;
  ImuReport now_;
  std::atomic<std::uint64_t> passes_{0};
  Histogram imu_to_page_;
  LatestValue<ImuReport> report_;
};

}  // namespace slamd
