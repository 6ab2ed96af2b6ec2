#pragma once
// The board as a whole: samples to frames, commands to replies, faults to the stream, and when the watchdog may be fed.
// No registers: the board hands in time, data-ready, bytes and the state of the port.

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/command_reader.hpp"
#include "firmware/core/led.hpp"
#include "firmware/core/outbox.hpp"
#include "firmware/core/sensor.hpp"
#include "firmware/core/usb_control.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd {

/// What does not change while the board runs.
struct BoardFacts {
  UniqueId id{};
  std::uint8_t chip_revision = 0;
  ResetCause reset_cause = ResetCause::kPower;
};

/// What the board's own parts counted since start.
struct BoardCounters {
  std::uint32_t usb_resets = 0;
  std::uint32_t usb_suspends = 0;
  Micros longest_loop = 0;
};

class Device {
 public:
  Device(SensorBus& bus, const BoardFacts& facts) : facts_{facts}, sensor_{bus} {}

  /// One pass: sensor, frames, unasked statistics. Call as Sensor::step().
  void step(Micros now, const DataReady& ready);

  /// Bytes from the host, any split of its packets.
  void receive(std::span<const std::uint8_t> bytes, Micros now);

  /// The board's own counts, for the statistics.
  void set_counters(const BoardCounters& counters) { counters_ = counters; }

  /// Somebody has the port open and the bus is awake.
  void set_open(bool open) { outbox_.set_open(open); }

  /// The next packet for the host; only when has_packet().
  bool has_packet() const { return !outbox_.empty(); }
  WirePacket next_packet() { return outbox_.next(); }

  /// A start anew, asked by USB or by command, happens 100 ms later: the answer goes out first.
  void request_start(StartRequest request, Micros now);
  StartRequest due_start(Micros now) const;

  /// The work goes on: the watchdog may be fed.
  bool alive(Micros now) const;

  LedState led(bool suspended) const;

 private:
  void add_sample(const RawSample& sample, Micros now);
  void add_fault_frame(Micros now);
  void tell_changes(Micros now);
  ImuFrame new_frame(Micros stamp);
  void execute(const Command& command, Micros now);
  void acknowledge(const Command& command, CommandResult result);
  void begin_self_test(const Command& command);
  Identity identity(std::uint16_t tag) const;
  Statistics statistics(std::uint16_t tag, Micros now) const;

  BoardFacts facts_;
  BoardCounters counters_;
  Sensor sensor_;
  CommandReader reader_;
  Outbox outbox_;
  std::uint32_t samples_ = 0;
  std::uint32_t longest_latency_ = 0;
  std::uint16_t sequence_ = 0;
  std::uint16_t test_tag_ = 0;
  SensorState told_state_ = SensorState::kStarting;
  SensorFault told_fault_ = SensorFault::kNone;
  Micros next_fault_frame_ = 0;
  StartRequest start_ = StartRequest::kNone;
  Micros start_at_ = 0;
};

}  // namespace slamd
