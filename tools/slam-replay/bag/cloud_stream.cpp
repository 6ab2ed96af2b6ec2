#include "tools/slam-replay/bag/cloud_stream.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace slamd::replay {
namespace {

constexpr double kSweep_cdeg = 35'990.0;  // of a whole cloud, so that the next one's begin is a turn on
constexpr double kLongest_s = 1.0;        // from a cloud's first point to its last

class CloudStream : public Stream<LidarPacket> {
 public:
  CloudStream(TopicSource topic, const CloudStreamConfig& config)
      : sensor_{topic.sensor}, reader_{std::move(topic)}, config_{config} {}

  const LidarPacket* next() override {
    while (given_points_ == points_.size()) {
      const PointCloud2Message* message = reader_.next();
      if (message == nullptr) return nullptr;
      if (!load(*message)) ++refused_;
    }
    fill();
    ++given_;
    return &packet_;
  }

  StreamReport report() const override {
    StreamReport report;
    report.items = given_;
    report.rejections.push_back({sensor_, "out_of_range", refused_});
    reader_.tell(report);
    return report;
  }
  double progress() const override { return reader_.progress(); }

 private:
  struct Timed {
    double time_s;  // after the cloud's stamp
    LidarPoint point;
  };

  /// False for a cloud that is none.
  bool load(const PointCloud2Message& message) {
    points_.clear();
    given_points_ = 0;
    const std::optional<CloudPoints> cloud = read_points(message);
    if (!cloud) return false;
    if (!cloud->has_ring && !rings_) rings_.emplace(cloud->points);
    stamp_ = reader_.time(message.stamp_ns);
    const std::vector<double> times_s = point_times(*cloud, message.stamp_ns, config_.timing);
    for (std::size_t i = 0; i < times_s.size(); ++i) add(cloud->points[i], times_s[i], cloud->has_ring);
    std::stable_sort(points_.begin(), points_.end(), [](const Timed& a, const Timed& b) { return a.time_s < b.time_s; });
    const bool is_sweep = points_.empty() || points_.back().time_s - points_.front().time_s <= kLongest_s;
    if (!is_sweep) points_.clear();
    if (!points_.empty()) arrival_ = order_.next(stamp_ + from_seconds(points_.back().time_s));
    return is_sweep;
  }

  void add(const CloudPoint& p, double time_s, bool has_ring) {
    const double range_m = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    if (range_m < config_.min_range_m || range_m > config_.max_range_m || !(std::abs(time_s) <= kLongest_s)) return;
    const double clockwise_deg = std::fmod(360.0 - std::atan2(p.y, p.x) * 180.0 / std::numbers::pi, 360.0);
    LidarPoint point{};
    point.x = p.x;
    point.y = p.y;
    point.z = p.z;
    point.azimuth_cdeg = static_cast<std::uint16_t>(std::min(35'999.0, clockwise_deg * 100.0));
    point.ring = has_ring ? p.ring : rings_->ring(p);
    point.intensity = static_cast<std::uint8_t>(std::clamp(std::isnan(p.intensity) ? 0.0F : p.intensity, 0.0F, 255.0F));
    points_.push_back({time_s, point});
  }

  void fill() {
    const double first_s = points_.front().time_s;
    const double sweep_s = std::max(1e-9, points_.back().time_s - first_s);
    const auto phase = [&](double time_s) { return static_cast<std::uint16_t>(kSweep_cdeg * (time_s - first_s) / sweep_s); };
    const std::size_t begin = given_points_;
    const std::size_t end = std::min(points_.size(), begin + LidarPacket::kMaxPoints);
    const double begin_s = points_[begin].time_s;
    packet_.time = stamp_ + from_seconds(begin_s);
    packet_.arrival = arrival_;
    packet_.span = from_seconds(points_[end - 1].time_s - begin_s);
    packet_.azimuth_begin_cdeg = phase(begin_s);
    packet_.azimuth_end_cdeg = phase(points_[end - 1].time_s);
    packet_.point_count = static_cast<std::uint16_t>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      LidarPoint& point = packet_.points[i - begin] = points_[i].point;
      point.time_offset_ns = static_cast<std::int32_t>(from_seconds(points_[i].time_s - begin_s).count());
    }
    given_points_ = end;
  }

  std::string sensor_;
  TopicReader<PointCloud2Message> reader_;
  CloudStreamConfig config_;
  std::optional<RingFinder> rings_;  // of clouds without rings, by the first one
  HostTime stamp_, arrival_;         // of the cloud in work
  std::vector<Timed> points_;        // of it
  std::size_t given_points_ = 0;
  ArrivalOrder order_;
  LidarPacket packet_;
  std::uint64_t given_ = 0, refused_ = 0;
};

}  // namespace

std::unique_ptr<Stream<LidarPacket>> cloud_stream(TopicSource topic, const CloudStreamConfig& config) {
  return std::make_unique<CloudStream>(std::move(topic), config);
}

}  // namespace slamd::replay
