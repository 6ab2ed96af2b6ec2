#include "tools/imu-flash/stream_check.hpp"

#include <cstdio>
#include <optional>

#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/io/usb_serial_source.hpp"

namespace slamd::flash {
namespace {

constexpr Duration kReadTimeout = std::chrono::milliseconds{100};

/// Time of the device from the first to the newest frame, and how many periods lie between.
struct Span {
  std::optional<ImuFrame> first;
  ImuFrame last;
  std::uint64_t frames = 0;
  std::uint64_t faults = 0;

  void add(const ImuFrame& frame) {
    if (!first) first = frame;
    last = frame;
    ++frames;
    faults += frame.has(ImuStatus::kSensorFault) ? 1 : 0;
  }
  double seconds() const { return static_cast<double>(last.device_us - first->device_us) * 1e-6; }
  std::uint64_t periods() const { return static_cast<std::uint16_t>(last.sequence - first->sequence); }
};

Span read_span(ByteSource& source, Duration span, Duration patience) {
  Span seen;
  ImuFrameParser parser;
  HostTime deadline = ReopenTimer::now() + patience;
  while (ReopenTimer::now() < deadline) {
    const SourceRead read = source.read(kReadTimeout);
    for (const std::uint8_t byte : read.bytes) {
      const std::optional<ImuFrame> frame = parser.take(byte);
      if (!frame) continue;
      if (!seen.first) deadline = ReopenTimer::now() + span;
      seen.add(*frame);
    }
  }
  return seen;
}

}  // namespace

StreamReport check_stream(const UsbListing& board, Duration span, Duration patience) {
  UsbSerialSource source{{.id = board.id, .serial = board.serial, .reopen = {}}};
  const Span seen = read_span(source, span, patience);
  StreamReport report;
  if (seen.frames < 2 || seen.last.device_us <= seen.first->device_us) {
    report.failure = "the board runs our firmware, but sends no samples";
    return report;
  }
  char text[200];
  std::snprintf(text, sizeof text, "firmware %x.%02x, serial %s: %.1f Hz measured over %.1f s, %llu samples missing",
                unsigned{board.release} >> 8U, unsigned{board.release} & 0xFFU, board.serial.c_str(),
                static_cast<double>(seen.periods()) / seen.seconds(), seen.seconds(),
                static_cast<unsigned long long>(seen.periods() + 1 - seen.frames));
  report.text = text;
  if (seen.faults > 0) report.failure = "the board reports a fault of its sensor: see imu-monitor";
  return report;
}

}  // namespace slamd::flash
