#pragma once
// All that get_status says besides the pose: named probes that are asked when somebody wants to know. It measures
// nothing itself and never touches a real-time thread: probes read atomics.

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/health/histogram.hpp"
#include "daemon/ring/spsc_ring.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

/// How well the device's clock is known.
struct ClockHealth {
  bool locked = false;
  double skew_ppm = 0.0;  // device seconds are this much shorter than the host's
  double skew_sigma_ppm = 0.0;
  double sigma_s = 0.0;      // of a sample's host time
  std::uint32_t jumps = 0;  // of either clock, resets of the device among them
};

/// What a probe says of one sensor. Counts are totals since the start.
struct SourceHealth {
  HostTime last_arrival;          // of the newest good item; only meaningful when received > 0
  std::uint64_t received = 0;     // good items (packets, samples, sentences)
  std::uint64_t lost = 0;         // never arrived, as told by stamps or sequence numbers
  std::string device{};            // "udp:0.0.0.0:2368", "/dev/ttyACM0"
  std::string state{};            // one word, e.g. "healthy", "absent"
  std::string reason{};           // likewise: "silent"; "none" where all is well
  HostTime state_since{};         // only meaningful with a state
  std::uint32_t times_faulty = 0;
  std::vector<std::pair<std::string, std::uint64_t>> rejected{};  // by cause
  std::vector<std::pair<std::string, std::uint64_t>> events{};    // what happened, e.g. "resets"
  std::optional<ClockHealth> clock{};                             // of devices with a clock
};

class HealthBoard {
 public:
  using SourceProbe = std::function<SourceHealth()>;
  using RingProbe = std::function<RingCounts()>;
  using CountProbe = std::function<std::uint64_t()>;
  using ObjectProbe = std::function<nlohmann::json()>;

  explicit HealthBoard(HostTime start) : start_{start} {}

  /// Registration: before the server starts, from one thread. Probes are called on the server's thread, may allocate
  /// but not block, and what they refer to must outlive the server.
  void add_source(std::string name, SourceProbe probe);
  void add_ring(std::string name, RingProbe probe);
  void add_stage(std::string name, const Histogram& histogram);  // in status as milliseconds: "scan", "imu_to_page"
  void add_count(std::string name, CountProbe probe);            // any further total: "scans", "keyframes"

  void add_object(std::string name, ObjectProbe probe);        // whatever else a part says of itself

  /// Server's thread, about once a second: takes the counts that rates are made of.
  void sample(HostTime now);

  /// Server's thread. The object that get_status gives under "health".
  nlohmann::json to_json(HostTime now) const;

 private:
  struct Source {
    std::string name;
    SourceProbe probe;
    std::uint64_t previous = 0;  // received at the last sample()
    double rate_hz = 0.0;
  };

  HostTime start_;
  HostTime sampled_;
  std::vector<Source> sources_;
  std::vector<std::pair<std::string, RingProbe>> rings_;
  std::vector<std::pair<std::string, const Histogram*>> stages_;
  std::vector<std::pair<std::string, CountProbe>> counts_;
  std::vector<std::pair<std::string, ObjectProbe>> objects_;
};

}  // namespace slamd
