#pragma once
// The thread of a spinning LiDAR: datagrams of the data and the position port to decoded packets in the ring. Real-time; it makes
// no scans and decides nothing.

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>

#include "daemon/health/health_board.hpp"
#include "daemon/inject/sensor_fault.hpp"
#include "daemon/ring/latest_value.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/recorder.hpp"
#include "daemon/threads/streams.hpp"
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
};

/// What the thread has seen; totals since the start.
struct LidarReport {
  HostTime last_received;  // of the newest datagram; only meaningful when decoder.received > 0
  HostTime last_arrival;   // of the newest accepted packet; only meaningful when packets > 0
  std::uint64_t packets = 0;  // handed on
  LidarStats decoder;
  UdpStats socket;
  LidarSideStats side;  // of the position port
  ClockHealth clock;
};

class LidarThread {
 public:
  /// Binds both ports; fails with the step that failed. config.model is one that spins; streams must outlive the thread.
  [[nodiscard]] static Result<LidarThread> open(const LidarThreadConfig& config, const LidarDecoderConfig& decoder,
                                                Streams& streams);

  /// Before run(): every datagram goes to `tap` as well, which must outlive the thread.
  void record_to(WireTap& tap) { tap_ = &tap; }
  /// Before run(): failures may be played on this sensor's data packets.
  void allow_faults();
  /// The thread's body: returns within a tenth of a second after a stop request.
  void run(const std::stop_token& stop);

  /// Any thread.
  LidarReport report() const { return report_->load().value_or(LidarReport{}); }

 private:
  LidarThread(UdpSource packets, UdpSource positions, SpinningLidar lidar, Streams& streams);
  void receive();
  void decode(const UdpPacket& packet) SLAMD_NONBLOCKING;
  void read_positions();

  UdpSource packets_;
  UdpSource positions_;
  SpinningLidar lidar_;
  Streams& streams_;
  WireTap* tap_ = nullptr;
  std::unique_ptr<SensorFault<LidarValueFault>> faults_;  // null: none may be played
  LidarReport now_;
  std::unique_ptr<LatestValue<LidarReport>> report_;
};

}  // namespace slamd
