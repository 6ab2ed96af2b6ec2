#include "drivers/imu/imu_frame_parser.hpp"

#include "drivers/imu/imu_scale.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd {
namespace {

Eigen::Vector3d scaled(const std::array<std::int16_t, 3>& counts, double unit) {
  return unit * Eigen::Vector3d{static_cast<double>(counts[0]), static_cast<double>(counts[1]),
                                static_cast<double>(counts[2])};
}

bool clips(const ImuFrame& frame, const ImuSample& sample) {
  return frame.has(ImuStatus::kGyroClipped) || frame.has(ImuStatus::kAccelClipped) ||
         sample.gyro_rads.cwiseAbs().maxCoeff() >= kGyroClipRads ||
         sample.accel_mps2.cwiseAbs().maxCoeff() >= kAccelClipMps2;
}

/// A whole packet of another kind that the board sends.
bool is_reply(std::span<const std::uint8_t> packet) {
  const std::optional<OpenedPacket> opened = open_packet(packet);
  return opened && (read_packet<Identity>(*opened) || read_packet<Statistics>(*opened) || read_packet<SelfTestReport>(*opened) ||
                    read_packet<Acknowledgement>(*opened));
}

}  // namespace

ImuFrameParser::Config ImuFrameParser::Config::defaults() {
  Config config;
  config.clock.min_latency = Duration{300'000};
  config.clock.envelope.expected_jitter_s = 1.5e-3;
  return config;
}

std::optional<ImuFrame> ImuFrameParser::take(std::uint8_t byte) {
  const std::optional<SplitPacket> packet = splitter_.take(byte);
  if (!packet) return std::nullopt;
  const DecodedImuFrame decoded = decode_imu_packet(packet->bytes);
  if (decoded) return decoded.frame;
  if (is_reply(packet->bytes)) {
    ++stats_.replies;
    return std::nullopt;
  }
  ++stats_.rejected[static_cast<std::size_t>(decoded.error)];
  stats_.garbage_bytes += packet->size + 1;
  return std::nullopt;
}

/// The device's clock went on by what the host saw pass, within the tolerance.
bool ImuFrameParser::follows(const Stamp& earlier, const Stamp& later) const {
  const Duration difference = (later.device - earlier.device) - (later.arrival - earlier.arrival);
  return later.device > earlier.device && abs(difference) < config_.stamp_tolerance;
}

/// A stamp far from the expected one needs a second that agrees: 16 bits of CRC let one garbage frame in 65,536 pass.
bool ImuFrameParser::accept_stamp(const Stamp& stamp) {
  if (last_ && !follows(*last_, stamp)) {
    if (stamp.device == last_->device && stamp.sequence == last_->sequence) {
      ++stats_.repeated;
      return false;
    }
    if (!suspect_ || !follows(*suspect_, stamp)) {
      suspect_ = stamp;
      ++stats_.implausible;
      return false;
    }
    ++stats_.resets;
  } else if (last_) {
    const auto steps = static_cast<std::uint16_t>(stamp.sequence - last_->sequence);
    if (steps != 1) ++stats_.gaps;
    stats_.missing += steps > 1 ? steps - 1U : 0U;
  }
  suspect_.reset();
  last_ = stamp;
  return true;
}

std::optional<ImuSample> ImuFrameParser::convert(const ImuFrame& frame, HostTime arrival) {
  if (frame.device_us > static_cast<std::uint64_t>(Duration::max().count()) / 2000U) {
    ++stats_.implausible;
    return std::nullopt;
  }
  const DeviceTime device{std::chrono::microseconds{static_cast<std::int64_t>(frame.device_us)}};
  if (!accept_stamp({device, arrival, frame.sequence})) return std::nullopt;
  stats_.dropped_at_device = frame.dropped;

  ImuSample sample;
  sample.time = clock_.update(device, arrival);
  if (frame.has(ImuStatus::kSensorFault)) {
    ++stats_.sensor_faults;
    return std::nullopt;
  }
  sample.arrival = arrival;
  sample.clock_unsure = clock_.is_recovering();
  sample.gyro_rads = scaled(frame.gyro, kGyroRadsPerLsb);
  sample.accel_mps2 = scaled(frame.accel, kAccelMps2PerLsb);
  sample.temperature_c = static_cast<float>(kImuTemperatureZeroC + frame.temperature / kImuTemperatureLsbPerC);
  sample.clipped = clips(frame, sample);
  stats_.clipped += sample.clipped ? 1 : 0;
  ++stats_.samples;
  return sample;
}

}  // namespace slamd
