#include "tools/slam-replay/bag/topic_probe.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/ros/messages.hpp"

namespace slamd::replay {
namespace {

constexpr std::size_t kMessages = 50;
constexpr Duration kSameClock = std::chrono::seconds{1};

double middle(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

double norm(const ImuMessage& imu) {
  return std::hypot(imu.linear_acceleration[0], imu.linear_acceleration[1], imu.linear_acceleration[2]);
}

}  // namespace

TopicProbe probe(const Bag& bag, std::size_t topic) {
  const Topic& about = bag.topics()[topic];
  const RosEncoding encoding = about.encoding.value_or(RosEncoding::kCdr);
  const std::unique_ptr<BagCursor> cursor = bag.read(topic);
  TopicProbe found;
  std::vector<double> periods_s, norms;
  std::optional<std::int64_t> last_ns;
  Duration least = Duration::max();
  for (std::size_t i = 0; i < kMessages; ++i) {
    const BagMessage* message = cursor->next();
    if (message == nullptr) break;
    if (const auto imu = about.type == ImuMessage::kType ? read_message<ImuMessage>(message->bytes, encoding) : std::nullopt) {
      norms.push_back(norm(*imu));
    }
    const std::optional<std::int64_t> stamp_ns = read_stamp_ns(message->bytes, encoding);
    if (!stamp_ns || *stamp_ns == 0 || !is_host_ns(*stamp_ns)) continue;
    least = std::min(least, message->recorded - from_ns<HostTime>(*stamp_ns));
    if (last_ns) periods_s.push_back(static_cast<double>(*stamp_ns - *last_ns) * 1e-9);
    last_ns = stamp_ns;
  }
  found.stamped = last_ns.has_value();
  if (found.stamped) found.least_lag = least;
  found.period_s = middle(periods_s);
  found.accel_norm = middle(norms);
  return found;
}

std::vector<TopicClock> clocks(const std::vector<TopicProbe>& probes) {
  Duration least = Duration::max(), most = Duration::min();
  bool all_stamped = true;
  for (const TopicProbe& probe : probes) {
    all_stamped = all_stamped && probe.stamped;
    if (!probe.stamped) continue;
    least = std::min(least, probe.least_lag);
    most = std::max(most, probe.least_lag);
  }
  const bool of_one_clock = all_stamped && !probes.empty() && most - least <= kSameClock;
  std::vector<TopicClock> clocks;
  for (const TopicProbe& probe : probes) {
    const bool is_foreign = std::chrono::abs(probe.least_lag) > kSameClock;
    clocks.emplace_back(probe.stamped, !of_one_clock && is_foreign ? probe.least_lag : Duration{});
  }
  return clocks;
}

}  // namespace slamd::replay
