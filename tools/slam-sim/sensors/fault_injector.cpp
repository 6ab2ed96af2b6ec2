#include "tools/slam-sim/sensors/fault_injector.hpp"

#include <cmath>

#include "firmware/protocol/imu_frame.hpp"

namespace slamd::sim {
namespace {

/// Everything of the LiDAR shares its cable and fate.
bool concerns(const Fault& fault, Channel channel) {
  return fault.sensor == channel ||
         (fault.sensor == Channel::kLidar && (channel == Channel::kPosition || channel == Channel::kLidarImu));
}

}  // namespace

std::optional<WireEvent> FaultInjector::apply(WireEvent event) {
  const double t = static_cast<double>(event.taken_ns) * 1e-9;
  bool stuck = false;
  for (const Fault& fault : faults_) {
    if (!concerns(fault, event.channel) || !fault.active(t)) continue;
    stuck = stuck || fault.kind == FaultKind::kStuck;
    if (!apply_one(fault, event)) return std::nullopt;
  }
  if (!stuck) {
    auto& last = healthy_[static_cast<std::size_t>(event.channel)];
    if (!last.empty() && last.front().taken_ns != event.taken_ns) last.clear();
    last.push_back(event);
  }
  return event;
}

bool FaultInjector::apply_one(const Fault& fault, WireEvent& event) {
  switch (fault.kind) {
    case FaultKind::kOff:
    case FaultKind::kGap:
      return false;
    case FaultKind::kLoss:
      return !rng_.chance(fault.value);
    case FaultKind::kLate:
      event.arrival_ns += std::llround(fault.value * 1e9);
      return true;
    case FaultKind::kStuck:
      repeat_last(event);
      return true;
    case FaultKind::kCorrupt:
      for (std::uint8_t& byte : event.bytes) {
        if (rng_.chance(fault.value)) byte = static_cast<std::uint8_t>(byte ^ (1U << rng_.index(8)));
      }
      return true;
    case FaultKind::kJump:
    case FaultKind::kClockJump:
    case FaultKind::kClockSkew:
      return true;
  }
  return true;
}

/// The IMU goes on counting and stamping the same values; the others repeat their last bytes.
void FaultInjector::repeat_last(WireEvent& event) {
  const auto channel = static_cast<std::size_t>(event.channel);
  const auto& last = healthy_[channel];
  if (last.empty()) return;
  const auto& source = last[replayed_[channel]++ % last.size()];
  if (event.channel != Channel::kImu) {
    event.bytes = source.bytes;
    return;
  }
  const auto packet = [](const WireEvent& e) {
    return std::span<const std::uint8_t>{e.bytes}.first(kImuFramePacketBytes);
  };
  const DecodedImuFrame old = decode_imu_packet(packet(source));
  DecodedImuFrame now = decode_imu_packet(packet(event));
  if (!old || !now) return;  // one of them is damaged: it stays as it is
  now.frame.gyro = old.frame.gyro;
  now.frame.accel = old.frame.accel;
  const auto bytes = encode(now.frame);
  event.bytes.assign(bytes.begin(), bytes.end());
}

}  // namespace slamd::sim
