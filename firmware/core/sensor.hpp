#pragma once
// The LSM6DSOX from power-up to samples, and back after any fault: a state machine that never waits. Frames, sequence
// and host are Device's business, the bus's electrical side is the bus's.

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/core/data_ready.hpp"
#include "firmware/core/lsm6dsox.hpp"
#include "firmware/core/micros.hpp"
#include "firmware/core/raw_sample.hpp"
#include "firmware/core/self_test.hpp"
#include "firmware/core/sensor_bus.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd {

/// Since start; they wrap.
struct SensorCounters {
  std::uint32_t overruns = 0;    // samples lost in the sensor
  std::uint32_t faults = 0;      // times the sensor was lost
  std::uint32_t restarts = 0;    // attempts to get it back
  std::uint32_t recoveries = 0;  // of these, bus freed by clocks
};

class Sensor {
 public:
  explicit Sensor(SensorBus& bus) : bus_{bus} {}

  /// One step: looks at the bus, starts the next transfer. Returns a sample when one is complete. Call at every
  /// interrupt and at least every millisecond; O(1) but for SensorBus::recover().
  std::optional<RawSample> step(Micros now, const DataReady& ready);

  /// Asks for the built-in self-test; it takes about 0.4 s, without samples. False when the sensor is not measuring.
  bool begin_self_test();
  /// Its result, once; kNotRun when the sensor was lost meanwhile.
  std::optional<SelfTestReport> take_report();

  SensorState state() const;
  SensorFault fault() const { return fault_; }
  std::uint8_t id() const { return id_; }
  const SensorCounters& counters() const { return counters_; }
  /// When the state machine last did something; it does at least every 0.4 s, whatever the sensor does.
  Micros last_progress() const { return progress_at_; }

 private:
  enum class Phase : std::uint8_t {
    kRestart,
    kIdentify,
    kReset,
    kAwaitReset,
    kSettings,
    kVerify,
    kMeasure,
    kSettle,
    kTest
  };

  struct Test {
    bool wanted = false;
    std::optional<SelfTest> running;
    std::optional<SelfTestReport> report;
  };

  void begin(Micros now, const DataReady& ready);
  void begin_sample(Micros now, const DataReady& ready);
  std::optional<RawSample> finish(Micros now, const DataReady& ready);
  std::optional<RawSample> finish_sample(const DataReady& ready, Micros now);
  void finish_setup(Micros now, const DataReady& ready);
  void finish_settings(Micros now);
  void add_to_test(const RawSample& sample);
  void restart(Micros now);
  void fail(SensorFault fault, Micros now);
  void write_settings(std::span<const lsm6dsox::Setting> settings, Phase then);
  void await_data(Micros now, const DataReady& ready);
  bool settings_hold() const;

  SensorBus& bus_;
  Phase phase_ = Phase::kRestart;
  bool transferring_ = false;
  bool faulty_ = false;
  bool overrun_ = false;  // to be told with the next sample
  Phase after_settings_ = Phase::kVerify;
  SensorFault fault_ = SensorFault::kNone;
  std::uint8_t id_ = 0;
  Micros wake_at_ = 20'000;  // the sensor boots for 10 ms after power-up
  Micros progress_at_ = 0;
  Micros deadline_ = 0;  // of the transfer, of the sensor's reset, or of the next data-ready
  std::span<const lsm6dsox::Setting> settings_;
  DataReady reading_;  // the edge whose sample is being read, or was last
  SensorCounters counters_;
  Test test_;
};

}  // namespace slamd
