#include "tools/slam-replay/bag/topic_streams.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::replay {
namespace {

constexpr double kMostGyro_rads = 100.0;
constexpr double kMostAccel_mps2 = 1'000.0;
constexpr std::size_t kMostBeams = 100'000;

/// Convert: optional<Item> operator()(const Message&, const TopicReader<Message>&), nothing for a message of which no item comes.
template <class Message, class Item, class Convert>
class TopicStream : public Stream<Item> {
 public:
  TopicStream(TopicSource topic, Convert convert) : sensor_{topic.sensor}, reader_{std::move(topic)}, convert_{convert} {}

  const Item* next() override {
    while (const Message* message = reader_.next()) {
      item_ = convert_(*message, reader_);
      if (!item_) {
        ++refused_;
        continue;
      }
      item_->arrival = order_.next(item_->arrival);
      ++given_;
      return &*item_;
    }
    return nullptr;
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
  std::string sensor_;
  TopicReader<Message> reader_;
  Convert convert_;
  ArrivalOrder order_;
  std::optional<Item> item_;
  std::uint64_t given_ = 0, refused_ = 0;
};

template <class Message, class Item, class Convert>
std::unique_ptr<Stream<Item>> make_stream(TopicSource topic, Convert convert) {
  return std::make_unique<TopicStream<Message, Item, Convert>>(std::move(topic), convert);
}

struct ToImuSample {
  double accel_scale;

  std::optional<ImuSample> operator()(const ImuMessage& message, const TopicReader<ImuMessage>& topic) const {
    ImuSample sample;
    sample.time = sample.arrival = topic.time(message.stamp_ns);
    sample.gyro_rads = Eigen::Vector3d::Map(message.angular_velocity.data());
    sample.accel_mps2 = accel_scale * Eigen::Vector3d::Map(message.linear_acceleration.data());
    const bool is_sound = sample.gyro_rads.cwiseAbs().maxCoeff() <= kMostGyro_rads &&  // false also for NaN
                          sample.accel_mps2.cwiseAbs().maxCoeff() <= kMostAccel_mps2 && sample.gyro_rads.allFinite() &&
                          sample.accel_mps2.allFinite();
    return is_sound ? std::optional{sample} : std::nullopt;
  }
};

GnssQuality quality(std::int8_t status) {
  if (status < 0) return GnssQuality::kNone;
  if (status == 0) return GnssQuality::kAutonomous;
  return status == 1 ? GnssQuality::kDifferential : GnssQuality::kRtkFloat;
}

struct ToFix {
  GnssNoiseConfig noise;

  std::optional<GnssFix> operator()(const NavSatFixMessage& message, const TopicReader<NavSatFixMessage>& topic) const {
    GnssFix fix;
    fix.quality = quality(message.status);
    const bool is_sound = std::abs(message.latitude_deg) <= 90.0 && std::abs(message.longitude_deg) <= 180.0;
    if (fix.quality == GnssQuality::kNone || !is_sound) return std::nullopt;
    fix.time = fix.arrival = topic.time(message.stamp_ns);
    fix.latitude_deg = message.latitude_deg;
    fix.longitude_deg = message.longitude_deg;
    fix.height_valid = std::isfinite(message.altitude_m);
    fix.height_m = fix.height_valid ? message.altitude_m : 0.0;
    fix.sigma_horizontal_m = sigma((message.covariance[0] + message.covariance[4]) / 2.0, message.covariance_type, 1.0);
    fix.sigma_vertical_m = sigma(message.covariance[8], message.covariance_type, noise.vertical_factor);
    return fix;
  }

  double sigma(double variance, std::uint8_t type, double factor) const {
    const bool is_told = type != 0 && variance > 0.0 && std::isfinite(variance);
    return std::clamp(is_told ? std::sqrt(variance) : factor * noise.sigma_max_m, factor * noise.sigma_min_m, factor * noise.sigma_max_m);
  }
};

struct ToLaserScan {
  std::optional<LaserScan> operator()(const LaserScanMessage& message, const TopicReader<LaserScanMessage>& topic) const {
    const bool is_sound = std::isfinite(message.angle_min) && std::isfinite(message.angle_increment) &&
                          std::abs(message.time_increment) < 1.0F && message.range_max > 0.0F && std::isfinite(message.range_max) &&
                          message.ranges.size() <= kMostBeams && !message.ranges.empty();
    if (!is_sound) return std::nullopt;
    LaserScan scan;
    scan.time = topic.time(message.stamp_ns);
    scan.range_max_m = message.range_max;
    scan.beams.reserve(message.ranges.size());
    for (std::size_t i = 0; i < message.ranges.size(); ++i) {
      const float range = message.ranges[i];
      const bool hit = range >= message.range_min && range <= message.range_max;  // false for NaN and infinity
      const auto n = static_cast<float>(i);
      scan.beams.push_back({message.angle_min + n * message.angle_increment, hit ? range : 0.0F, n * std::max(0.0F, message.time_increment)});
    }
    scan.arrival = scan.time + from_seconds(scan.beams.back().time_s);
    return scan;
  }
};

struct ToWheelOdometry {
  std::optional<WheelOdometry> operator()(const OdometryMessage& message, const TopicReader<OdometryMessage>& topic) {
    const auto& [x, y, z, w] = message.rotation_xyzw;
    const double yaw = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    const bool is_sound = std::isfinite(message.position[0]) && std::isfinite(message.position[1]) && std::isfinite(yaw);
    if (!is_sound) return std::nullopt;
    WheelOdometry odometry;
    odometry.time = odometry.arrival = topic.time(message.stamp_ns);
    odometry.x_m = message.position[0];
    odometry.y_m = message.position[1];
    odometry.yaw_rad = yaw_rad += std::remainder(yaw - yaw_rad, 2.0 * std::numbers::pi);
    return odometry;
  }

  double yaw_rad = 0.0;  // of the newest, continuous
};

}  // namespace

std::unique_ptr<Stream<ImuSample>> imu_stream(TopicSource topic, double accel_scale) {
  return make_stream<ImuMessage, ImuSample>(std::move(topic), ToImuSample{accel_scale});
}

std::unique_ptr<Stream<GnssFix>> fix_stream(TopicSource topic, const GnssNoiseConfig& noise) {
  return make_stream<NavSatFixMessage, GnssFix>(std::move(topic), ToFix{noise});
}

std::unique_ptr<Stream<LaserScan>> laser_stream(TopicSource topic) {
  return make_stream<LaserScanMessage, LaserScan>(std::move(topic), ToLaserScan{});
}

std::unique_ptr<Stream<WheelOdometry>> odometry_stream(TopicSource topic) {
  return make_stream<OdometryMessage, WheelOdometry>(std::move(topic), ToWheelOdometry{});
}

}  // namespace slamd::replay
