#include "drivers/rplidar/rplidar_parser.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

namespace slamd {
namespace {

using std::chrono::microseconds;

constexpr Duration kLongestPeriod = microseconds{2'000};
constexpr Duration kShortestPeriod = microseconds{30};
constexpr double kPeriodSigma_ppm = 10'000.0;  // of what the sensor says of its sample period
constexpr double kJitter_s = 1.7e-3;           // of arrivals through a USB adapter

bool is_period(Duration period) { return period >= kShortestPeriod && period <= kLongestPeriod; }

std::size_t samples_of(RplidarAnswer answer) {
  if (answer == RplidarAnswer::kBoost) return 96;
  return answer == RplidarAnswer::kExpress ? 32 : kRplidarNodesTogether;
}

std::size_t bytes_of(RplidarAnswer answer) {
  if (answer == RplidarAnswer::kBoost) return kRplidarBoostBytes;
  return answer == RplidarAnswer::kExpress ? kRplidarExpressBytes : kRplidarNodeBytes;
}

/// What firmware does that tells nothing else: 8,000 samples a second, 4,000 in the other modes.
Duration usual_period(RplidarAnswer answer) { return answer == RplidarAnswer::kBoost ? microseconds{125} : microseconds{250}; }

}  // namespace

RplidarParser::RplidarParser(const Config& config) : config_{config} {
  open_.beams.reserve(kMaxBeams);
  scan_.beams.reserve(kMaxBeams);
}

void RplidarParser::restart() {
  reader_.restart();
  unpacker_.restart();
  clock_.reset();
  told_period_.reset();
  rates_.reset();
  is_open_ = false;
}

/// Answers that say how fast the sensor samples, and begins of streams.
void RplidarParser::note(const RplidarPacket& packet) {
  if (packet.bytes.empty()) return begin_stream(packet.answer);
  if (packet.answer == RplidarAnswer::kSampleRate) rates_ = parse_rplidar_sample_rate(packet.bytes);
  if (packet.answer != RplidarAnswer::kConfig) return;
  const std::optional<RplidarConfigValue> entry = parse_rplidar_config(packet.bytes);
  if (!entry || entry->key != RplidarConfigKey::kSamplePeriod) return;
  const Duration period{std::int64_t{entry->value} * 1'000 / 256};
  if (is_period(period)) told_period_ = period;
}

/// What the sensor says where it says something believable.
Duration RplidarParser::period_of(RplidarAnswer answer) const {
  if (answer != RplidarAnswer::kScan && told_period_) return *told_period_;
  if (!rates_ || answer == RplidarAnswer::kBoost) return usual_period(answer);
  const Duration period = microseconds{answer == RplidarAnswer::kScan ? rates_->standard_us : rates_->express_us};
  return is_period(period) ? period : usual_period(answer);
}

void RplidarParser::begin_stream(RplidarAnswer answer) {
  unpacker_.restart();
  is_open_ = false;
  period_ = period_of(answer);
  packet_period_ = static_cast<std::int64_t>(samples_of(answer)) * period_;
  ClockSync::Config clock;
  clock.envelope.skew_sigma_ppm = kPeriodSigma_ppm;
  clock.envelope.expected_jitter_s = kJitter_s;
  const double wire_s = 10.0 * static_cast<double>(bytes_of(answer)) / config_.baud;
  clock.min_latency = config_.latency + from_seconds(wire_s);
  clock_.emplace(clock);
  packet_end_ = HostTime{};
}

/// Samples whose directions this packet settles; sample_time_ is then that of the first of them.
std::span<const RplidarSample> RplidarParser::timed(const RplidarPacket& packet, HostTime arrival) {
  if (!clock_) return {};
  const std::uint64_t gaps = unpacker_.gaps();
  const std::optional<RplidarSamples> found = unpacker_.take(packet);
  const bool is_node = packet.answer == RplidarAnswer::kScan;
  if (is_node && !found) return {};
  const HostTime before = packet_end_;
  const bool is_next = unpacker_.gaps() == gaps;
  const Duration passed = arrival - std::exchange(packet_arrival_, arrival);
  counted_ += (is_next ? 1 : std::max<std::int64_t>(1, (passed + packet_period_ / 2) / packet_period_)) * packet_period_;
  packet_end_ = clock_->update(counted_, arrival);
  if (!found) return {};
  const HostTime last = found->is_delayed ? before : packet_end_;
  sample_time_ = last - static_cast<std::int64_t>(found->samples.size() - 1) * period_;
  return found->samples;
}

/// True when the sample ended a revolution, which then stands in scan_.
bool RplidarParser::add(const RplidarSample& sample, HostTime arrival) {
  const HostTime time = std::exchange(sample_time_, sample_time_ + period_);
  ++stats_.samples;
  bool finished = false;
  if (sample.begins_turn) {
    finished = is_open_ && !open_.beams.empty();
    if (finished) std::swap(open_, scan_);
    if (finished) ++stats_.scans;
    is_open_ = true;
    open_.time = time;
    open_.range_max_m = static_cast<float>(config_.max_range_m);
    open_.beams.clear();
  }
  if (!is_open_) return false;
  if (open_.beams.size() == kMaxBeams) {
    ++stats_.too_many;
    return finished;
  }
  const auto range = static_cast<double>(sample.range_m);
  const bool inside = range >= config_.min_range_m && range <= config_.max_range_m;
  stats_.out_of_range += !inside && sample.range_m > 0.0F ? 1 : 0;
  constexpr float kPi = std::numbers::pi_v<float>;
  const float angle_rad = sample.angle_rad > kPi ? 2.0F * kPi - sample.angle_rad : -sample.angle_rad;
  open_.beams.push_back({angle_rad, inside ? sample.range_m : 0.0F, static_cast<float>(to_seconds(time - open_.time))});
  open_.arrival = arrival;
  return finished;
}

}  // namespace slamd
