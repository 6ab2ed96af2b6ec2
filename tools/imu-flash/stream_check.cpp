#include "tools/imu-flash/stream_check.hpp"

#include <cstdio>
#include <optional>

#include "drivers/imu/packet_splitter.hpp"
#include "drivers/io/usb_serial_source.hpp"
#include "firmware/protocol/command.hpp"
#include "firmware/protocol/imu_frame.hpp"
#include "firmware/protocol/reply.hpp"
#include "tools/imu-flash/board.hpp"

namespace slamd::flash {
namespace {

constexpr Duration kReadTimeout = std::chrono::milliseconds{100};

/// What the stream said: the first and the newest sample, and the board's answer to who it is.
struct Heard {
  std::optional<ImuFrame> first;
  ImuFrame last;
  std::uint64_t frames = 0;
  std::uint64_t faults = 0;
  std::optional<Identity> identity;

  void add(std::span<const std::uint8_t> packet) {
    if (const DecodedImuFrame decoded = decode_imu_packet(packet)) {
      if (!first) first = decoded.frame;
      last = decoded.frame;
      ++frames;
      faults += last.has(ImuStatus::kSensorFault) ? 1 : 0;
    } else if (const std::optional<OpenedPacket> opened = open_packet(packet)) {
      if (const std::optional<Identity> answer = read_packet<Identity>(*opened)) identity = answer;
    }
  }
  double seconds() const { return static_cast<double>(last.device_us - first->device_us) * 1e-6; }
  std::uint64_t periods() const { return static_cast<std::uint16_t>(last.sequence - first->sequence); }
};

/// Until `span` after the first sample, or `patience` without one.
Heard listen(ByteSource& source, Duration span, Duration patience) {
  Heard heard;
  PacketSplitter splitter;
  bool asked = false;
  HostTime deadline = ReopenTimer::now() + patience;
  while (ReopenTimer::now() < deadline) {
    const SourceRead read = source.read(kReadTimeout);
    if (!asked && source.is_open())
      asked = source.write(encode(Command{static_cast<std::uint8_t>(CommandCode::kIdentity), 1}));
    const bool silent_before = !heard.first;
    for (const std::uint8_t byte : read.bytes) {
      if (const std::optional<SplitPacket> packet = splitter.take(byte)) heard.add(packet->bytes);
    }
    if (silent_before && heard.first) deadline = ReopenTimer::now() + span;
  }
  return heard;
}

std::string version_of(const UsbListing& board, const std::optional<Identity>& identity) {
  if (!identity) return version_text(board.release);
  char text[32];
  std::snprintf(text, sizeof text, "%u.%u.%u", unsigned{identity->version[0]}, unsigned{identity->version[1]},
                unsigned{identity->version[2]});
  return text;
}

}  // namespace

StreamReport check_stream(const UsbListing& board, Duration span, Duration patience) {
  UsbSerialSource source{{.id = board.id, .serial = board.serial, .reopen = {}}};
  const Heard heard = listen(source, span, patience);
  StreamReport report;
  if (heard.frames < 2 || heard.last.device_us <= heard.first->device_us) {
    report.failure = "the board runs our firmware, but sends no samples";
    return report;
  }
  char rate[100];
  std::snprintf(rate, sizeof rate, "%.1f Hz measured over %.1f s, %lld samples missing",
                static_cast<double>(heard.periods()) / heard.seconds(), heard.seconds(),
                static_cast<long long>(heard.periods()) + 1 - static_cast<long long>(heard.frames));
  report.text = "firmware " + version_of(board, heard.identity) + ", serial " + board.serial + ": " + rate;
  if (heard.faults > 0) report.failure = "the board reports a fault of its sensor: see imu-monitor";
  return report;
}

}  // namespace slamd::flash
