#pragma once
// The thread of an RPLIDAR: keeps it scanning over its serial port, and hands its scans on. Real-time but for the writes of requests,
// which come at a start only; it matches nothing.

#include <stop_token>

#include "daemon/ring/nonblocking.hpp"
#include "daemon/threads/lidar_thread.hpp"
#include "drivers/rplidar/rplidar_parser.hpp"
#include "drivers/rplidar/rplidar_session.hpp"

namespace slamd {

class RplidarThread final : public LidarThread {
 public:
  /// streams must outlive it.
  RplidarThread(const LidarThreadConfig& config, const LidarDecoderConfig& decoder, Streams& streams);

  void run(const std::stop_token& stop) override;

 private:
  void ask();
  void take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING;
  void note();

  SerialSource source_;
  RplidarParser parser_;
  RplidarSession session_;
  Streams& streams_;
  std::uint64_t openings_ = 0;  // of the port, that the session knows of
};

}  // namespace slamd
