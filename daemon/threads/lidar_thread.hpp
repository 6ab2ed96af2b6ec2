#pragma once
// The LiDAR's thread, whichever LiDAR it is: what the daemon tells it and hears of it. The models' own threads are
// spinning_lidar_thread and rplidar_thread.

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "daemon/health/health_board.hpp"
#include "daemon/ring/latest_value.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/streams.hpp"
#include "drivers/io/lidar_stats.hpp"
#include "drivers/io/serial_source.hpp"
#include "drivers/io/udp_source.hpp"
#include "drivers/lidar/spinning_lidar.hpp"

namespace slamd {

struct LidarThreadConfig {
  std::string model = "vlp16";         // as drivers/lidar names it
  std::string bind_address = "0.0.0.0";
  std::uint16_t port = 2368;           // data packets
  std::uint16_t position_port = 8308;  // position packets (state of the pulse per second); of an Airy: device packets
  std::string source_address;          // when not empty, datagrams of others are dropped and counted
  std::uint16_t source_port = 0;           // likewise unless 0: the sensor's own port of its data packets,
  std::uint16_t position_source_port = 0;  // and of its position packets
  int receive_buffer_bytes = 4 << 20;
  SerialSourceConfig serial{.path = "/dev/slamd-rplidar", .baud = 115'200, .raise_dtr = false};  // of an RPLIDAR
};

/// What the thread has seen; totals since the start.
struct LidarReport {
  HostTime last_received;  // of the newest datagram or bytes; only meaningful when decoder.received > 0
  HostTime last_arrival;   // of the newest good packet; only meaningful when packets > 0
  std::uint64_t packets = 0;  // good ones; of an RPLIDAR capsules, or samples of its standard scan
  LidarStats decoder;
  UdpStats socket;
  LidarSideStats side;  // of the position port
  ClockHealth clock;
};

class LidarThread {
 public:
  /// For the configured model: binds its ports, or knows its serial port, which may be absent. Fails with the step that failed.
  /// streams must outlive the thread.
  [[nodiscard]] static Result<std::unique_ptr<LidarThread>> open(const LidarThreadConfig& config, const LidarDecoderConfig& decoder,
                                                                 Streams& streams);
  virtual ~LidarThread() = default;

  /// Before run(): everything read goes to `tap` as well, which must outlive the thread.
  void record_to(WireTap& tap) { tap_ = &tap; }
  /// Before run(): failures may be played on this sensor's data, where its thread can play them.
  virtual void allow_faults() {}
  /// The thread's body: returns within a tenth of a second after a stop request.
  virtual void run(const std::stop_token& stop) = 0;

  /// Any thread.
  LidarReport report() const { return report_.load().value_or(LidarReport{}); }

 protected:
  void tell() { report_.store(now_); }

  WireTap* tap_ = nullptr;
  LidarReport now_;

 private:
  LatestValue<LidarReport> report_;
};

/// Name of the file of a recording that its bytes go to: those of a serial port are told from datagrams by it.
const char* recorded_file(const LidarThreadConfig& config);
/// For people: "udp:0.0.0.0:2368", "/dev/slamd-rplidar".
std::string device_name(const LidarThreadConfig& config);

}  // namespace slamd
