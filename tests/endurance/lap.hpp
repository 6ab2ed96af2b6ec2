#pragma once
// The wire bytes of one simulated lap, repeated for hours with their stamps moved on as the devices' own clocks would: past hours,
// counters' ends, midnights. Not for drives that end elsewhere than they began.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "estimator/types/result.hpp"
#include "estimator/types/time.hpp"

namespace slamd::endurance {

/// What of a drive is repeated: a whole number of seconds and, to some ten microseconds, of revolutions, so that nothing jumps.
struct LapPlan {
  HostTime begin;                 // arrival of its first LiDAR packet
  std::int64_t seconds = 0;       // by which the receiver's clock moves on each time,
  Duration period{};              // and by which all others do: of the LiDAR's packets
};

/// Looks at lidar.pcap of a folder of `slam-sim --serial-bytes --lidar-skew 0 --imu-skew 0` (600 rpm, one return) whose vehicle rests
/// for 20 s at its start. Fails where there is none.
Result<LapPlan> plan_lap(const std::string& folder);

class Lap {
 public:
  Lap(const std::string& folder, const LapPlan& plan);

  /// The names of the drive folder's captures that write() gives.
  static constexpr std::array<const char*, 3> kWires{"lidar.pcap", "imu.pcap", "gps.pcap"};

  /// A capture of that wire (index of kWires), lap after lap until `length` is over; `path` may be a pipe.
  void write(std::size_t wire, Duration length, const std::string& path) const;

 private:
  struct Read {
    HostTime arrival;
    std::uint16_t port = 0;
    std::vector<std::uint8_t> bytes;
  };

  std::vector<std::uint8_t> moved_on(std::size_t wire, const Read& read, std::int64_t laps) const;

  LapPlan plan_;
  std::array<std::vector<Read>, 3> reads_;
};

}  // namespace slamd::endurance
