#include "drivers/rplidar/rplidar_session.hpp"

namespace slamd {

void RplidarSession::enter(Step step) {
  step_ = step;
  sent_ = false;
  tries_ = 0;
}

void RplidarSession::restart() {
  way_ = Way::kExpress;
  info_.reset();
  health_.reset();
  enter(Step::kStop);
}

std::optional<RplidarRequest> RplidarSession::poll(HostTime now) {
  if (sent_ && now >= deadline_) time_out();
  if (sent_) return std::nullopt;
  sent_ = true;
  deadline_ = now + patience();
  stats_.resets += step_ == Step::kReset ? 1 : 0;
  return request();
}

std::optional<RplidarRequest> RplidarSession::request() const {
  switch (step_) {
    case Step::kStop: return rplidar_request(RplidarCommand::kStop);
    case Step::kInfo: return rplidar_request(RplidarCommand::kGetInfo);
    case Step::kHealth: return rplidar_request(RplidarCommand::kGetHealth);
    case Step::kReset: return rplidar_request(RplidarCommand::kReset);
    case Step::kRate: return rplidar_request(RplidarCommand::kGetSampleRate);
    case Step::kMode: return rplidar_config_request(RplidarConfigKey::kTypicalMode);
    case Step::kModeAnswer: return rplidar_config_request(RplidarConfigKey::kModeAnswer, mode_);
    case Step::kModePeriod: return rplidar_config_request(RplidarConfigKey::kSamplePeriod, mode_);
    case Step::kMotor: return rplidar_motor_request(config_.motor_duty);
    case Step::kScan:
      if (way_ == Way::kStandard) return rplidar_request(RplidarCommand::kScan);
      return rplidar_express_request(way_ == Way::kTypical ? static_cast<std::uint8_t>(mode_) : std::uint8_t{0});
    case Step::kRunning:
    case Step::kPause: break;
  }
  return std::nullopt;
}

Duration RplidarSession::patience() const {
  switch (step_) {
    case Step::kStop: return config_.settle;
    case Step::kReset: return config_.boot;
    case Step::kMotor: return config_.spin_up;
    case Step::kRunning: return config_.silence;
    case Step::kPause: return config_.pause;
    default: return config_.answer_timeout;
  }
}

/// The wait is over: of steps that only wait, that is how they end; of the others, the sensor did not answer.
void RplidarSession::time_out() {
  switch (step_) {
    case Step::kStop: return enter(Step::kInfo);
    case Step::kReset:
    case Step::kPause: return enter(Step::kStop);
    case Step::kMotor: return enter(Step::kScan);
    case Step::kRunning: ++stats_.stalls; return enter(Step::kStop);
    default: break;
  }
  ++stats_.timeouts;
  if (step_ == Step::kRate) return enter(Step::kMode);  // firmware before 1.17 does not know the question,
  const bool is_about_modes = step_ == Step::kMode || step_ == Step::kModeAnswer || step_ == Step::kModePeriod;
  if (is_about_modes) return enter(Step::kMotor);  // nor that before 1.24 this one
  if (step_ == Step::kScan && way_ != Way::kStandard) {
    way_ = way_ == Way::kTypical ? Way::kExpress : Way::kStandard;
    return enter(Step::kScan);
  }
  if (step_ != Step::kScan && ++tries_ < config_.tries) {
    sent_ = false;
    return;
  }
  ++stats_.failures;
  way_ = Way::kExpress;
  enter(Step::kPause);
}

void RplidarSession::heard(HostTime now) {
  if (step_ == Step::kRunning) deadline_ = now + config_.silence;
}

void RplidarSession::take(const RplidarPacket& packet, HostTime now) {
  if (packet.bytes.empty() && step_ == Step::kScan) {
    ++stats_.starts;
    enter(Step::kRunning);
    sent_ = true;
    return heard(now);
  }
  if (packet.answer == RplidarAnswer::kInfo && step_ == Step::kInfo) {
    info_ = parse_rplidar_info(packet.bytes);
    enter(Step::kHealth);
  } else if (packet.answer == RplidarAnswer::kHealth && step_ == Step::kHealth) {
    health_ = parse_rplidar_health(packet.bytes);
    if (health_) enter(*health_ == RplidarHealth::kError ? Step::kReset : Step::kRate);
  } else if (packet.answer == RplidarAnswer::kSampleRate && step_ == Step::kRate) {
    enter(Step::kMode);
  } else if (packet.answer == RplidarAnswer::kConfig) {
    take_config(packet);
  }
}

void RplidarSession::take_config(const RplidarPacket& packet) {
  const std::optional<RplidarConfigValue> entry = parse_rplidar_config(packet.bytes);
  if (!entry) return;
  if (step_ == Step::kMode && entry->key == RplidarConfigKey::kTypicalMode) {
    mode_ = static_cast<std::uint16_t>(entry->value);
    enter(Step::kModeAnswer);
  } else if (step_ == Step::kModeAnswer && entry->key == RplidarConfigKey::kModeAnswer) {
    const auto answer = static_cast<std::uint8_t>(entry->value);
    const bool known = answer == static_cast<std::uint8_t>(RplidarAnswer::kBoost) ||
                       answer == static_cast<std::uint8_t>(RplidarAnswer::kExpress);
    way_ = known ? Way::kTypical : Way::kExpress;
    enter(known ? Step::kModePeriod : Step::kMotor);
  } else if (step_ == Step::kModePeriod && entry->key == RplidarConfigKey::kSamplePeriod) {
    enter(Step::kMotor);
  }
}

}  // namespace slamd
