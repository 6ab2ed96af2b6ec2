#pragma once
// Records what the wires bring, byte for byte with the receive stamps, as a drive folder that slam-replay turns into the
// same poses. Driver threads hand reads over through rings and never wait; it judges and repairs nothing.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "daemon/ring/spsc_ring.hpp"
#include "daemon/threads/scan_budget.hpp"
#include "drivers/io/pcap_sink.hpp"
#include "drivers/io/udp_packet.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// A datagram, or a read of a serial port, on its way to the file.
struct RecordedRead {
  UdpPacket read;  // its payload lies in `bytes`
  std::size_t size = 0;
  std::array<std::uint8_t, 1500> bytes;
};

/// One driver thread's way to the recorder: a read that finds the ring full is dropped and counted.
class WireTap {
 public:
  /// reads  that may wait for the recorder.
  explicit WireTap(std::size_t reads) : ring_{reads} {}

  /// The driver's thread, before it parses: copies the bytes. Wait-free; a read longer than a slot takes several.
  void take(const UdpPacket& read);
  /// The recorder's thread: everything that waits. True when there was anything.
  bool drain(PcapSink& file);

  RingCounts counts() const { return ring_.counts(); }

 private:
  SpscRing<RecordedRead> ring_;
};

/// Files: lidar.pcap (both ports), imu.pcap and gps.pcap (each read of the serial port a datagram without ports),
/// scan_shares.csv (the scans for which the estimator had too little time), slamd.yaml (the configuration that was in force).
class Recorder {
 public:
  /// Makes the folder and its files; fails when there is a recording already or a file cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> open(const std::string& folder, const std::string& config_yaml);

  WireTap& lidar() { return lidar_; }
  WireTap& imu() { return imu_; }
  WireTap& gnss() { return gnss_; }
  /// For the estimator's thread.
  SpscRing<LimitedScan>& limited() { return limited_; }

  /// The thread's body, not real-time: returns soon after a stop request with all written that was taken before it. When
  /// a file cannot be written any more it ends early, and the taps drop.
  void run(const std::stop_token& stop);

  /// Any thread: the files could not be written to the end.
  bool failed() const { return failed_.load(std::memory_order_relaxed); }

 private:
  struct Files {
    PcapSink lidar, imu, gnss;
    std::ofstream shares;
  };

  explicit Recorder(Files files) : files_{std::move(files)} {}
  bool drain();
  bool drain_shares();

  WireTap lidar_{4096};  // 5 s
  WireTap imu_{2048};    // 10 s
  WireTap gnss_{512};
  SpscRing<LimitedScan> limited_{256};
  Files files_;
  std::atomic<bool> failed_{false};
};

}  // namespace slamd
