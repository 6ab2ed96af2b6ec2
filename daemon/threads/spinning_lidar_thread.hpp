#pragma once
// The thread of a spinning LiDAR: datagrams of the data and the position port to decoded packets in the ring. Real-time; it makes
// no scans and decides nothing.

#include <memory>
#include <stop_token>

#include "daemon/inject/sensor_fault.hpp"
#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/lidar_thread.hpp"

namespace slamd {

class SpinningLidarThread final : public LidarThread {
 public:
  /// streams must outlive it.
  SpinningLidarThread(UdpSource packets, UdpSource positions, SpinningLidar lidar, Streams& streams);

  void allow_faults() override;
  void run(const std::stop_token& stop) override;

 private:
  void receive();
  void decode(const UdpPacket& packet) SLAMD_NONBLOCKING;
  void read_positions();

  UdpSource packets_;
  UdpSource positions_;
  SpinningLidar lidar_;
  Streams& streams_;
  std::unique_ptr<SensorFault<LidarValueFault>> faults_;  // null: none may be played
};

}  // namespace slamd
