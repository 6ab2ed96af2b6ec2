#pragma once
// Topics of values as streams: Imu, NavSatFix, LaserScan, Odometry. Not those of bytes (topic_reads.hpp) and not clouds
// (cloud_stream.hpp).

#include <memory>

#include "drivers/gnss/gnss_noise.hpp"
#include "estimator/types/gnss_fix.hpp"
#include "estimator/types/imu_sample.hpp"
#include "estimator/types/laser_scan.hpp"
#include "estimator/types/wheel_odometry.hpp"
#include "tools/slam-replay/bag/topic.hpp"

namespace slamd::replay {

/// accel_scale  metres per square second of one unit of the messages: 1, or g where a driver sends g
std::unique_ptr<Stream<ImuSample>> imu_stream(TopicSource topic, double accel_scale);
/// The covariance's sigma within the noise's bounds, sigma_max_m where a message says none.
std::unique_ptr<Stream<GnssFix>> fix_stream(TopicSource topic, const GnssNoiseConfig& noise);
std::unique_ptr<Stream<LaserScan>> laser_stream(TopicSource topic);
/// Position and yaw in the plane; yaw goes on over half turns.
std::unique_ptr<Stream<WheelOdometry>> odometry_stream(TopicSource topic);

}  // namespace slamd::replay
