#pragma once
// Records what the wires bring, byte for byte with the receive stamps, as a drive folder that slam-replay turns into the
// same poses; and keeps the newest of it in memory, to be dumped when something has gone wrong. Driver threads hand reads over
// through rings and never wait; it judges and repairs nothing.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "daemon/ring/spsc_ring.hpp"
#include "daemon/threads/flight_ring.hpp"
#include "daemon/threads/mcap_recorder.hpp"
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
  explicit WireTap(std::size_t reads) : ring_{reads, [](RecordedRead& slot) { slot.bytes.fill(0); }} {}  // resident

  /// The driver's thread, before it parses: copies the bytes. Wait-free; a read longer than a slot takes several.
  void take(const UdpPacket& read);
  /// The recorder's thread: calls take(read) for everything that waits. True when there was anything.
  template <class Take>
  bool drain(Take&& take) {
    bool any = false;
    for (; RecordedRead* slot = ring_.front(); ring_.pop()) {
      slot->read.payload = {slot->bytes.data(), slot->size};
      take(slot->read);
      any = true;
    }
    return any;
  }

  RingCounts counts() const { return ring_.counts(); }

 private:
  SpscRing<RecordedRead> ring_;
};

struct FlightRecorderConfig {
  Duration span = std::chrono::seconds{60};        // of what the wires brought, kept in memory; 0: none
  std::size_t byte_budget = 64U * 1024 * 1024;     // of it, nearly all of it for the LiDAR
  std::string folder;                              // of the dumps; empty: "dumps" in the service manager's state directory
  std::uint32_t max_dumps = 10;                    // more are not written before old ones have been taken away

  /// Where dumps go; empty: nowhere.
  std::string dump_folder() const;
};

/// Files: lidar.pcap (both ports; of an RPLIDAR rplidar.pcap), imu.pcap, gps.pcap and wheel.pcap (each read of the serial port a datagram without ports),
/// scan_shares.csv (the scans for which the estimator had too little time), slamd.yaml (the configuration that was in force);
/// of a dump also dump.json (why).
class Recorder {
 public:
  /// Keeps the newest reads in memory. With a folder all reads go there as well: it and its files are made; fails when there is
  /// a recording already or a file cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> open(const std::string& folder, const std::string& config_yaml,
                                                              const FlightRecorderConfig& flight = {},
                                                              const char* lidar_file = "lidar.pcap");
  /// Before run(): recordings as MCAP may be asked for. `target` that ends in .mcap is recorded from the start on.
  Result<void> allow_mcap(std::unique_ptr<McapRecorder> mcap, const std::string& target = "");
  /// Null without allow_mcap().
  McapRecorder* mcap() { return mcap_.get(); }

  WireTap& lidar() { return lidar_.tap; }
  WireTap& imu() { return imu_.tap; }
  WireTap& gnss() { return gnss_.tap; }
  WireTap& wheel() { return wheel_.tap; }
  /// For the estimator's thread.
  SpscRing<LimitedScan>& limited() { return limited_; }

  /// The thread's body, not real-time: returns soon after a stop request with all written that was taken before it. When
  /// a file cannot be written any more that recording ends, and the newest reads are kept in memory all the same.
  void run(const std::stop_token& stop);

  /// Any thread but the recorder's. Writes what is kept as a drive folder `name` among the dumps; takes as long as the disk. The path of
  /// the folder comes back. name  a plain file name: no slash, no dot at its begin
  Result<std::string> dump(const std::string& name, const std::string& reason);
  /// Any thread: the recorder's own thread makes a dump soon. One that is asked for before it was made takes its place.
  void request_dump(const std::string& name, const std::string& reason);

  /// Any thread: the files could not be written to the end.
  bool failed() const { return failed_.load(std::memory_order_relaxed); }
  /// Any thread. Bytes kept in memory.
  std::size_t kept_bytes() const;
  /// Any thread. Dumps written, and those that could not be.
  std::uint64_t dumps() const { return dumps_.load(std::memory_order_relaxed); }
  std::uint64_t failed_dumps() const { return failed_dumps_.load(std::memory_order_relaxed); }

 private:
  struct Wire {
    const char* file_name;
    WireTap tap;
    FlightRing kept;
    RecordedWire wire;
    std::optional<PcapSink> file;  // none: not recorded from the start on
  };
  struct Request {
    std::string name, reason;
  };

  Recorder(const std::string& config_yaml, const FlightRecorderConfig& flight, const char* lidar_file);
  std::array<Wire*, 4> wires() { return {&lidar_, &imu_, &gnss_, &wheel_}; }
  Result<void> record_to(const std::string& folder);
  void drain();
  bool drain(Wire& wire);
  bool drain_shares();
  void take_request();
  Result<std::string> write_dump(const Request& request, bool draining);
  Result<void> write_wires(const std::string& folder, const std::string& reason, bool draining);

  const std::string config_yaml_;
  const FlightRecorderConfig flight_;
  std::unique_ptr<McapRecorder> mcap_;
  Wire lidar_;
  Wire imu_;
  Wire gnss_;
  Wire wheel_;
  SpscRing<LimitedScan> limited_{256};
  std::optional<std::ofstream> shares_;    // none: not recorded from the start on
  std::vector<LimitedScan> kept_shares_;   // with the mutex: of the span
  std::mutex mutex_;
  std::optional<Request> request_;
  std::atomic<bool> failed_{false};
  std::atomic<std::uint64_t> dumps_{0};
  std::atomic<std::uint64_t> failed_dumps_{0};
};

}  // namespace slamd
