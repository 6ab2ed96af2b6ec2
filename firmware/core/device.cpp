#include "firmware/core/device.hpp"

#include "firmware/core/version.hpp"

namespace slamd {
namespace {

constexpr Micros kFaultFrameEvery = 100'000;
constexpr Micros kStartAfter = 100'000;
constexpr Micros kStuckAfter = 700'000;  // the sensor's state machine moves at least every 0.4 s

constexpr std::uint8_t status_bit(ImuStatus bit, bool set) {
  return set ? static_cast<std::uint8_t>(bit) : 0;
}

constexpr std::uint16_t limited(std::uint64_t count) {
  return static_cast<std::uint16_t>(count < 0xFFFF ? count : 0xFFFF);
}

/// An axis at the end of its range.
constexpr bool clipped(const std::array<std::int16_t, 3>& axes) {
  for (const std::int16_t value : axes) {
    if (value == INT16_MAX || value == INT16_MIN) return true;
  }
  return false;
}

}  // namespace

void Device::step(Micros now, const DataReady& ready) {
  if (const auto sample = sensor_.step(now, ready)) add_sample(*sample, now);
  if (auto report = sensor_.take_report()) {
    report->tag = test_tag_;
    outbox_.push_reply(encode(*report));
  }
  tell_changes(now);
  if (told_state_ == SensorState::kFault && now >= next_fault_frame_) add_fault_frame(now);
}

void Device::tell_changes(Micros now) {
  const SensorState state = sensor_.state();
  const SensorFault fault = sensor_.fault();
  if (state == told_state_ && fault == told_fault_) return;
  if (state != told_state_) next_fault_frame_ = now;
  told_state_ = state;
  told_fault_ = fault;
  if (outbox_.open()) outbox_.push_reply(encode(statistics(0, now)));
}

ImuFrame Device::new_frame(Micros stamp) {
  ImuFrame frame;
  frame.status = status_bit(ImuStatus::kWatchdogReset, facts_.reset_cause == ResetCause::kWatchdog);
  frame.sequence = sequence_++;
  frame.device_us = stamp;
  return frame;
}

void Device::add_sample(const RawSample& sample, Micros now) {
  ImuFrame frame = new_frame(sample.stamp);
  frame.status = static_cast<std::uint8_t>(frame.status | status_bit(ImuStatus::kOverrun, sample.overrun) |
                                           status_bit(ImuStatus::kGyroClipped, clipped(sample.gyro)) |
                                           status_bit(ImuStatus::kAccelClipped, clipped(sample.accel)));
  frame.gyro = sample.gyro;
  frame.accel = sample.accel;
  frame.temperature = sample.temperature;
  outbox_.push(frame);
  ++samples_;
  const auto latency = static_cast<std::uint32_t>(now - sample.stamp);
  if (latency > longest_latency_) longest_latency_ = latency;
}

void Device::add_fault_frame(Micros now) {
  next_fault_frame_ = now + kFaultFrameEvery;
  ImuFrame frame = new_frame(now);
  frame.status |= static_cast<std::uint8_t>(ImuStatus::kSensorFault);
  outbox_.push(frame);
}

void Device::receive(std::span<const std::uint8_t> bytes, Micros now) {
  for (const std::uint8_t byte : bytes) {
    if (const auto command = reader_.take(byte)) execute(*command, now);
  }
}

void Device::execute(const Command& command, Micros now) {
  switch (static_cast<CommandCode>(command.code)) {
    case CommandCode::kIdentity:
      return outbox_.push_reply(encode(identity(command.tag)));
    case CommandCode::kStatistics:
      return outbox_.push_reply(encode(statistics(command.tag, now)));
    case CommandCode::kSelfTest:
      return begin_self_test(command);
    case CommandCode::kReset:
      request_start(StartRequest::kReset, now);
      break;
    case CommandCode::kBootLoader:
      request_start(StartRequest::kBootLoader, now);
      break;
    default:
      return acknowledge(command, CommandResult::kUnknown);
  }
  acknowledge(command, CommandResult::kAccepted);
}

void Device::acknowledge(const Command& command, CommandResult result) {
  outbox_.push_reply(encode(Acknowledgement{command.code, command.tag, result}));
}

void Device::begin_self_test(const Command& command) {
  if (sensor_.state() == SensorState::kSelfTest) return acknowledge(command, CommandResult::kBusy);
  test_tag_ = command.tag;
  if (sensor_.begin_self_test()) return;
  SelfTestReport not_run;
  not_run.tag = command.tag;
  outbox_.push_reply(encode(not_run));
}

Identity Device::identity(std::uint16_t tag) const {
  Identity identity;
  identity.sensor_id = sensor_.id();
  identity.tag = tag;
  identity.unique_id = facts_.id;
  identity.version = kFirmwareVersion;
  identity.chip_revision = facts_.chip_revision;
  identity.rate_hz = lsm6dsox::kRateHz;
  identity.gyro_range_dps = lsm6dsox::kGyroRangeDps;
  identity.accel_range_g = lsm6dsox::kAccelRangeG;
  return identity;
}

Statistics Device::statistics(std::uint16_t tag, Micros now) const {
  const SensorCounters& sensor = sensor_.counters();
  Statistics statistics;
  statistics.sensor_state = sensor_.state();
  statistics.fault = sensor_.fault();
  statistics.reset_cause = facts_.reset_cause;
  statistics.tag = tag;
  statistics.device_us = now;
  statistics.samples = samples_;
  statistics.dropped = outbox_.dropped();
  statistics.overruns = sensor.overruns;
  statistics.faults = sensor.faults;
  statistics.restarts = limited(sensor.restarts);
  statistics.bus_recoveries = limited(sensor.recoveries);
  statistics.usb_resets = limited(counters_.usb_resets);
  statistics.usb_suspends = limited(counters_.usb_suspends);
  statistics.bad_commands = limited(reader_.rejected());
  statistics.latency_max_us = limited(longest_latency_);
  statistics.loop_max_us = limited(counters_.longest_loop);
  statistics.queue_max_bytes = limited(outbox_.most_frames() * kImuFrameWireBytes);
  return statistics;
}

void Device::request_start(StartRequest request, Micros now) {
  if (request == StartRequest::kNone || start_ != StartRequest::kNone) return;
  start_ = request;
  start_at_ = now + kStartAfter;
}

StartRequest Device::due_start(Micros now) const {
  return now >= start_at_ ? start_ : StartRequest::kNone;
}

bool Device::alive(Micros now) const {
  return now - sensor_.last_progress() < kStuckAfter;
}

LedState Device::led(bool suspended) const {
  if (suspended) return LedState::kDark;
  if (sensor_.state() == SensorState::kFault) return LedState::kFault;
  return outbox_.open() ? LedState::kStreaming : LedState::kWaiting;
}

}  // namespace slamd
