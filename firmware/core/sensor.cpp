#include "firmware/core/sensor.hpp"

namespace slamd {
namespace {

using namespace lsm6dsox;

constexpr Micros kTransferTimeout = 5'000;  // a burst takes 0.4 ms
constexpr Micros kRetryAfter = 100'000;
constexpr Micros kResetPause = 2'000;
constexpr Micros kResetTimeout = 50'000;
constexpr Micros kDataTimeout = 50'000;        // ten samples
constexpr Micros kFirstDataTimeout = 300'000;  // the gyroscope turns on in 70 ms, its filters settle
constexpr Micros kTestSettling = 100'000;
constexpr std::size_t kVerifiedRegisters = 9;  // from kAccelControl on

}  // namespace

std::optional<RawSample> Sensor::step(Micros now, const DataReady& ready) {
  if (transferring_) {
    const BusState state = bus_.state();
    if (state == BusState::kBusy) {
      if (now > deadline_) fail(SensorFault::kBusHung, now);
      return std::nullopt;
    }
    transferring_ = false;
    progress_at_ = now;
    if (state == BusState::kDone) return finish(now, ready);
    fail(SensorFault::kNoAnswer, now);
  } else if (now >= wake_at_) {
    begin(now, ready);
  }
  return std::nullopt;
}

bool Sensor::begin_self_test() {
  if (phase_ != Phase::kMeasure || test_.wanted) return false;
  test_.wanted = true;
  return true;
}

std::optional<SelfTestReport> Sensor::take_report() {
  const std::optional<SelfTestReport> report = test_.report;
  test_.report.reset();
  return report;
}

SensorState Sensor::state() const {
  if (faulty_) return SensorState::kFault;
  if (test_.running || test_.wanted) return SensorState::kSelfTest;
  return phase_ == Phase::kMeasure ? SensorState::kRunning : SensorState::kStarting;
}

/// Starts the transfer of the phase, if there is one to start.
void Sensor::begin(Micros now, const DataReady& ready) {
  switch (phase_) {
    case Phase::kRestart:
      return restart(now);
    case Phase::kIdentify:
      bus_.read(kWhoAmI, 1);
      break;
    case Phase::kReset:
      bus_.write(kControl3, kSoftwareReset);
      break;
    case Phase::kAwaitReset:
      bus_.read(kControl3, 1);
      break;
    case Phase::kSettings:
      bus_.write(settings_.front().address, settings_.front().value);
      break;
    case Phase::kVerify:
      bus_.read(kAccelControl, kVerifiedRegisters);
      break;
    case Phase::kSettle:
      phase_ = Phase::kTest;
      return await_data(now, ready);
    case Phase::kMeasure:
    case Phase::kTest:
      return begin_sample(now, ready);
  }
  transferring_ = true;
  if (phase_ != Phase::kAwaitReset) deadline_ = now + kTransferTimeout;
}

void Sensor::begin_sample(Micros now, const DataReady& ready) {
  if (phase_ == Phase::kMeasure && test_.wanted) {
    test_.wanted = false;
    test_.running.emplace();
    return write_settings(kSelfTestReference, Phase::kSettle);
  }
  if (ready.edges == reading_.edges) {
    if (now > deadline_) fail(SensorFault::kNoData, now);
    return;
  }
  const std::uint32_t missed = ready.edges - reading_.edges - 1;
  counters_.overruns += missed;
  overrun_ = overrun_ || missed > 0;
  reading_ = ready;
  bus_.read(kTemperature, SensorBus::kMaxRead);
  transferring_ = true;
  deadline_ = now + kTransferTimeout;
}

std::optional<RawSample> Sensor::finish(Micros now, const DataReady& ready) {
  if (phase_ == Phase::kMeasure || phase_ == Phase::kTest) return finish_sample(ready, now);
  finish_setup(now, ready);
  return std::nullopt;
}

std::optional<RawSample> Sensor::finish_sample(const DataReady& ready, Micros now) {
  deadline_ = now + kDataTimeout;
  if (ready.edges != reading_.edges) {  // the next sample came while this one was read: its values may be mixed
    ++counters_.overruns;
    overrun_ = true;
    return std::nullopt;
  }
  RawSample sample;
  read_outputs(bus_.bytes(), sample);
  if (phase_ == Phase::kTest) {
    add_to_test(sample);
    return std::nullopt;
  }
  faulty_ = false;
  sample.stamp = reading_.stamp;
  sample.overrun = overrun_;
  overrun_ = false;
  return sample;
}

void Sensor::finish_setup(Micros now, const DataReady& ready) {
  switch (phase_) {
    case Phase::kIdentify:
      id_ = bus_.bytes().front();
      if (id_ != kId) return fail(SensorFault::kWrongId, now);
      phase_ = Phase::kReset;
      break;
    case Phase::kReset:
      phase_ = Phase::kAwaitReset;
      wake_at_ = now + kResetPause;
      deadline_ = now + kResetTimeout;
      break;
    case Phase::kAwaitReset:
      if ((bus_.bytes().front() & kSoftwareReset) == 0) return write_settings(kMeasure, Phase::kVerify);
      if (now > deadline_) return fail(SensorFault::kConfiguration, now);
      wake_at_ = now + kResetPause;
      break;
    case Phase::kSettings:
      return finish_settings(now);
    case Phase::kVerify:
      if (!settings_hold()) return fail(SensorFault::kConfiguration, now);
      phase_ = Phase::kMeasure;
      await_data(now, ready);
      break;
    default:
      break;
  }
}

void Sensor::finish_settings(Micros now) {
  settings_ = settings_.subspan(1);
  if (!settings_.empty()) return;
  phase_ = after_settings_;
  if (phase_ == Phase::kSettle) wake_at_ = now + kTestSettling;
}

/// Reference, then force, then the sensor is set up from reset.
void Sensor::add_to_test(const RawSample& sample) {
  switch (test_.running->add(sample)) {
    case SelfTest::Progress::kMore:
      return;
    case SelfTest::Progress::kHalf:
      return write_settings(kSelfTestForce, Phase::kSettle);
    case SelfTest::Progress::kComplete:
      test_.report = test_.running->report();
      test_.running.reset();
      phase_ = Phase::kReset;
  }
}

void Sensor::restart(Micros now) {
  progress_at_ = now;
  if (faulty_) ++counters_.restarts;
  if (faulty_ && fault_ == SensorFault::kBusHung) ++counters_.recoveries;
  if (!bus_.recover()) return fail(SensorFault::kBusHung, now);
  phase_ = Phase::kIdentify;
}

void Sensor::fail(SensorFault fault, Micros now) {
  progress_at_ = now;
  if (!faulty_) ++counters_.faults;
  if (test_.running || test_.wanted) test_.report = SelfTestReport{};
  test_.running.reset();
  test_.wanted = false;
  faulty_ = true;
  fault_ = fault;
  transferring_ = false;
  phase_ = Phase::kRestart;
  wake_at_ = now + kRetryAfter;
}

void Sensor::write_settings(std::span<const Setting> settings, Phase then) {
  settings_ = settings;
  after_settings_ = then;
  phase_ = Phase::kSettings;
}

/// Samples from before are not meant.
void Sensor::await_data(Micros now, const DataReady& ready) {
  reading_ = ready;
  overrun_ = false;
  progress_at_ = now;
  deadline_ = now + kFirstDataTimeout;
}

bool Sensor::settings_hold() const {
  for (const Setting& setting : kMeasure) {
    const std::size_t at = static_cast<std::size_t>(setting.address) - kAccelControl;
    if (setting.address >= kAccelControl && at < kVerifiedRegisters && bus_.bytes()[at] != setting.value) return false;
  }
  return true;
}

}  // namespace slamd
