#include "tools/imu-monitor/board_query.hpp"

#include <array>
#include <cstdio>

#include "drivers/imu/packet_splitter.hpp"
#include "drivers/io/reopen_timer.hpp"

namespace slamd::monitor {
namespace {

constexpr std::uint16_t kTag = 0x5A31;  // not 0: that is of statistics which come unasked
constexpr Duration kReadTimeout = std::chrono::milliseconds{100};
constexpr std::size_t kTagAt = 2;  // in every reply

template <std::size_t N, class Code>
const char* word(const std::array<const char*, N>& words, Code code) {
  const auto index = static_cast<std::size_t>(code);
  return index < N ? words[index] : "unknown";
}

bool is_sample(const OpenedPacket& packet) {
  return packet.kind() == kImuFrameKindVersion;
}

}  // namespace

std::optional<OpenedPacket> ask(ByteSource& board, CommandCode code, Duration patience) {
  PacketSplitter splitter;
  bool sent = false;
  const HostTime deadline = ReopenTimer::now() + patience;
  while (ReopenTimer::now() < deadline) {
    const SourceRead read = board.read(kReadTimeout);
    if (!sent && board.is_open()) sent = board.write(encode(Command{static_cast<std::uint8_t>(code), kTag}));
    for (const std::uint8_t byte : read.bytes) {
      const std::optional<SplitPacket> packet = splitter.take(byte);
      const std::optional<OpenedPacket> opened = packet ? open_packet(packet->bytes) : std::nullopt;
      if (!opened || is_sample(*opened) || wire::load<std::uint16_t>(opened->plain, kTagAt) != kTag) continue;
      if (read_packet<Acknowledgement>(*opened)) return std::nullopt;
      return opened;
    }
  }
  return std::nullopt;
}

std::string identity_text(const Identity& identity) {
  std::string id;
  char text[200];
  for (const std::uint8_t byte : identity.unique_id) {
    std::snprintf(text, sizeof text, "%02X", unsigned{byte});
    id += text;
  }
  std::snprintf(text, sizeof text,
                "firmware      %u.%u.%u, serial %s\nsensor        id 0x%02X%s, %u Hz, +-%u dps, +-%u g\n",
                unsigned{identity.version[0]}, unsigned{identity.version[1]}, unsigned{identity.version[2]}, id.c_str(),
                unsigned{identity.sensor_id}, identity.sensor_id == 0x6C ? " (LSM6DSOX)" : ": not an LSM6DSOX",
                unsigned{identity.rate_hz}, unsigned{identity.gyro_range_dps}, unsigned{identity.accel_range_g});
  return text;
}

std::string statistics_text(const Statistics& s) {
  constexpr std::array kStates{"starting", "running", "self-test", "fault"};
  constexpr std::array kFaults{"none",          "the sensor does not answer", "wrong WHO_AM_I", "the bus hangs",
                               "configuration", "data-ready stopped"};
  constexpr std::array kCauses{"power", "watchdog", "request"};
  char text[600];
  std::snprintf(text, sizeof text,
                "up            %.1f s, started by %s\nsensor state  %s, last fault: %s\n"
                "samples       %u taken, %u dropped, %u overruns\n"
                "faults        %u, %u restarts of the sensor, %u bus recoveries\n"
                "USB           %u resets, %u suspends, %u bad commands\n"
                "longest       data-ready to queue %u us, main loop %u us, %u bytes waiting\n",
                static_cast<double>(s.device_us) * 1e-6, word(kCauses, s.reset_cause), word(kStates, s.sensor_state),
                word(kFaults, s.fault), s.samples, s.dropped, s.overruns, s.faults, unsigned{s.restarts},
                unsigned{s.bus_recoveries}, unsigned{s.usb_resets}, unsigned{s.usb_suspends}, unsigned{s.bad_commands},
                unsigned{s.latency_max_us}, unsigned{s.loop_max_us}, unsigned{s.queue_max_bytes});
  return text;
}

std::string self_test_text(const SelfTestReport& report) {
  constexpr std::array kOutcomes{"passed", "FAILED", "not run: the sensor was lost"};
  constexpr std::array kAxes{"accel x", "accel y", "accel z", "gyro x", "gyro y", "gyro z"};
  std::string text = std::string{"self-test     "} + word(kOutcomes, report.outcome);
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    if ((report.failed_axes >> i & 1U) != 0) text += std::string{", "} + kAxes[i];
  }
  char line[160];
  std::snprintf(line, sizeof line,
                "\nresponse      accel %d %d %d mg (50 .. 1700), gyro %.1f %.1f %.1f dps (150 .. 700)\n",
                report.accel_mg[0], report.accel_mg[1], report.accel_mg[2], report.gyro_ddps[0] * 0.1,
                report.gyro_ddps[1] * 0.1, report.gyro_ddps[2] * 0.1);
  return text + line;
}

}  // namespace slamd::monitor
