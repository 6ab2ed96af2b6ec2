#pragma once
// What to ask of an RPLIDAR, and when, so that it scans and goes on scanning: stop, identity, health, scan mode, motor, scan; again after
// silence, errors and a replug. It sees answers and the time, and touches no port.

#include <cstdint>
#include <optional>

#include "drivers/rplidar/rplidar_protocol.hpp"
#include "drivers/rplidar/rplidar_reader.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct RplidarSessionConfig {
  std::uint16_t motor_duty = 660;                          // of 1023: 10 revolutions a second on an A2
  Duration answer_timeout = std::chrono::milliseconds{500};
  Duration settle = std::chrono::milliseconds{50};         // after a stop, until what was under way has arrived
  Duration spin_up = std::chrono::milliseconds{600};
  Duration boot = std::chrono::seconds{1};                 // after a reset
  Duration silence = std::chrono::seconds{1};              // without a packet for so long it is begun anew
  Duration pause = std::chrono::seconds{1};                // after a round without success
  int tries = 3;
};

struct RplidarSessionStats {
  std::uint64_t starts = 0;    // scans begun
  std::uint64_t stalls = 0;    // that fell silent
  std::uint64_t timeouts = 0;  // requests without an answer
  std::uint64_t resets = 0;    // for an error in its health
  std::uint64_t failures = 0;  // rounds without success
};

/// One thread uses an instance; no allocation.
class RplidarSession {
 public:
  enum class Step : std::uint8_t { kStop, kInfo, kHealth, kReset, kRate, kMode, kModeAnswer, kModePeriod, kMotor, kScan, kRunning, kPause };

  explicit RplidarSession(const RplidarSessionConfig& config = {}) : config_{config} {}

  /// What is to be sent now; ask again until there is nothing more. Before every wait for bytes, at least ten times a second.
  std::optional<RplidarRequest> poll(HostTime now);
  /// An answer, the begin of a stream (empty), or a packet of one.
  void take(const RplidarPacket& packet, HostTime now);
  /// Measurements arrive.
  void heard(HostTime now);
  /// The port was opened anew: everything from the begin.
  void restart();

  Step step() const { return step_; }
  const std::optional<RplidarInfo>& info() const { return info_; }
  std::optional<RplidarHealth> health() const { return health_; }
  const RplidarSessionStats& stats() const { return stats_; }

 private:
  enum class Way : std::uint8_t { kTypical, kExpress, kStandard };  // of scanning; older firmware knows only the later ones

  void enter(Step step);
  void time_out();
  std::optional<RplidarRequest> request() const;
  Duration patience() const;
  void take_config(const RplidarPacket& packet);

  RplidarSessionConfig config_;
  Step step_ = Step::kStop;
  bool sent_ = false;
  HostTime deadline_;
  int tries_ = 0;
  Way way_ = Way::kExpress;
  std::uint16_t mode_ = 0;  // the typical one
  std::optional<RplidarInfo> info_;
  std::optional<RplidarHealth> health_;
  RplidarSessionStats stats_;
};

}  // namespace slamd
