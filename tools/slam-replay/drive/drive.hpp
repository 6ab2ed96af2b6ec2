#pragma once
// A drive folder as one stream of events in order of arrival: the same drivers and the same merge as the daemon's, on
// recorded bytes.

#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "daemon/threads/event_merge.hpp"
#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_csv_reader.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/io/pcap_source.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"
#include "tools/slam-replay/drive/gps_csv_reader.hpp"
#include "tools/slam-replay/drive/wire_reader.hpp"

namespace slamd::replay {

struct DriveConfig {
  Vlp16Config vlp16;
  SampleClock::Config imu_clock;                                      // of imu.csv
  ImuFrameParser::Config imu_frames = ImuFrameParser::Config::defaults();  // of imu.pcap
  EventMergeConfig merge;
  NmeaParser::Config nmea = NmeaParser::Config::defaults();
  std::uint16_t lidar_port = 2368;
  bool with_gps = true;
};

/// Nothing came for a while, up to this instant.
struct Silence {
  HostTime until;
};

/// One event; a packet stays valid until the next one is asked for. std::monostate: the drive is over.
using Event = std::variant<std::monostate, Silence, ImuSample, const LidarPacket*, GnssFix>;

using ImuWireReader = WireReader<ImuFrameParser, ImuSample>;
using GpsWireReader = WireReader<NmeaParser, GnssFix>;

/// Any of lidar.pcap, imu.csv, gps.csv may be missing. Of a recording of slamd there are imu.pcap and gps.pcap instead, the
/// bytes of the serial ports: with them every event is as it was live, to the last bit.
class Drive {
 public:
  Drive(const std::string& folder, const DriveConfig& config);

  Event next();
  /// Of the points of the scan that ended then: less than 1 where the live estimator had no time for more.
  double scan_share(HostTime scan_end) const;
  /// Bytes of lidar.pcap read so far, 0..1; 0 without one.
  double progress() const;

  bool has_lidar() const { return pcap_.has_value(); }
  bool has_imu() const { return imu_wire_ || imu_reader_; }
  const Vlp16Stats& lidar_stats() const { return decoder_.stats(); }
  const PcapStats* pcap_stats() const { return pcap_ ? &pcap_->stats() : nullptr; }
  const ImuWireReader* imu_wire() const { return imu_wire_ ? &*imu_wire_ : nullptr; }
  const GpsWireReader* gps_wire() const { return gps_wire_ ? &*gps_wire_ : nullptr; }
  const ImuCsvReader* imu_reader() const { return imu_reader_ ? &*imu_reader_ : nullptr; }
  const GpsCsvReader* gps_reader() const { return gps_reader_ ? &*gps_reader_ : nullptr; }

 private:
  void open_imu(const std::string& folder);
  void open_gps(const std::string& folder);
  void read_shares(const std::string& path);
  void refill();
  std::optional<ImuSample> next_sample();
  std::optional<GnssFix> next_fix();
  const LidarPacket* next_packet();

  DriveConfig config_;
  std::ifstream imu_file_, gps_file_;
  std::optional<ImuCsvReader> imu_reader_;
  std::optional<GpsCsvReader> gps_reader_;
  std::optional<ImuWireReader> imu_wire_;
  std::optional<GpsWireReader> gps_wire_;
  std::optional<PcapSource> pcap_;
  Vlp16Decoder decoder_;
  EventMerge merge_;
  std::optional<ImuSample> imu_;
  std::optional<GnssFix> fix_;
  const LidarPacket* packet_ = nullptr;
  std::map<HostTime, double> shares_;  // of scan_shares.csv
};

}  // namespace slamd::replay
