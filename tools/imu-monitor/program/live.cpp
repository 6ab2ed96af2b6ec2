#include "tools/imu-monitor/program/live.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iomanip>

#include "drivers/io/reopen_timer.hpp"
#include "tools/imu-monitor/board_query.hpp"
#include "tools/imu-monitor/live_window.hpp"

namespace slamd::monitor {
namespace {

constexpr Duration kLinePeriod = std::chrono::seconds{1};
constexpr Duration kAnswerTime = std::chrono::seconds{3};
constexpr Duration kSelfTestTime = std::chrono::seconds{10};
constexpr Duration kReadTimeout = std::chrono::milliseconds{100};

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // the signal handler writes it

void on_interrupt(int) {
  interrupted = true;
}

void record(std::ofstream& file, const ImuSample& s) {
  file << s.arrival.time_since_epoch().count() << ',' << s.gyro_rads.x() << ',' << s.gyro_rads.y() << ','
       << s.gyro_rads.z() << ',' << s.accel_mps2.x() << ',' << s.accel_mps2.y() << ',' << s.accel_mps2.z() << ','
       << s.temperature_c << '\n';
}

void add_frames(LiveWindow& window, PacketSplitter& splitter, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    const std::optional<SplitPacket> packet = splitter.take(byte);
    if (!packet) continue;
    if (const DecodedImuFrame decoded = decode_imu_packet(packet->bytes)) window.add(decoded.frame);
  }
}

/// What to say when a second passed without samples.
std::string silence(const ByteSource& source, const ImuFrameParser& parser, std::uint64_t bytes_before) {
  if (!source.is_open()) return "no board there";
  if (source.stats().bytes == bytes_before) return "the board is open, but silent";
  if (parser.stats().sensor_faults > 0) return "the board reports a fault of its sensor";
  return "bytes come, but no samples: is it our firmware?";
}

}  // namespace

int query(const ImuSourceConfig& config, bool self_test) {
  const std::unique_ptr<ByteSource> board = make_imu_source(config);
  const std::optional<OpenedPacket> identity = ask(*board, CommandCode::kIdentity, kAnswerTime);
  const std::optional<OpenedPacket> statistics = ask(*board, CommandCode::kStatistics, kAnswerTime);
  if (!identity || !statistics || !read_packet<Identity>(*identity) || !read_packet<Statistics>(*statistics)) {
    std::fprintf(stderr, "imu-monitor: %s\n", board->is_open() ? "the board does not answer" : "no board there");
    return 1;
  }
  std::fputs((identity_text(*read_packet<Identity>(*identity)) + statistics_text(*read_packet<Statistics>(*statistics))).c_str(),
             stdout);
  if (!self_test) return 0;
  const std::optional<OpenedPacket> answer = ask(*board, CommandCode::kSelfTest, kSelfTestTime);
  const std::optional<SelfTestReport> report = answer ? read_packet<SelfTestReport>(*answer) : std::nullopt;
  if (!report) {
    std::fprintf(stderr, "imu-monitor: no result of the self-test\n");
    return 1;
  }
  std::fputs(self_test_text(*report).c_str(), stdout);
  return report->outcome == SelfTestOutcome::kPassed ? 0 : 1;
}

int watch(const LiveOptions& options) {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::ofstream file;
  if (!options.record_path.empty()) {
    file.open(options.record_path);
    file << std::setprecision(9) << "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c\n";
  }
  const std::unique_ptr<ByteSource> source = make_imu_source(options.source);
  ImuFrameParser parser;
  const HostTime begin = ReopenTimer::now();
  HostTime next_line = begin + kLinePeriod;
  LiveWindow window;
  std::uint64_t bytes_before = 0;
  PacketSplitter splitter;
  const auto is_over = [&](HostTime now) {
    return options.seconds > 0.0 && to_seconds(now - begin) >= options.seconds;
  };
  while (!interrupted && !is_over(ReopenTimer::now())) {
    const SourceRead read = source->read(kReadTimeout);
    add_frames(window, splitter, read.bytes);
    parser.feed(read.bytes, read.arrival, [&](const ImuSample& sample) {
      window.add(sample);
      if (file.is_open()) record(file, sample);
    });
    if (ReopenTimer::now() < next_line) continue;
    next_line += kLinePeriod;
    const std::string line = window.samples() > 0 ? live_line(window, parser) : silence(*source, parser, bytes_before);
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    window = {};
    bytes_before = source->stats().bytes;
  }
  if (!options.record_path.empty() && !file.flush()) {
    std::fprintf(stderr, "imu-monitor: %s cannot be written\n", options.record_path.c_str());
    return 1;
  }
  return parser.stats().samples > 0 ? 0 : 1;
}

}  // namespace slamd::monitor
