// Any bytes as a bag: ROS 1, SQLite or MCAP by their first bytes. It is refused with the file's name, or its sensors give sound items, end, and
// two readings are the same.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tools/slam-replay/bag/bag_sensors.hpp"
#include "tools/slam-replay/bag/own_recording.hpp"

namespace {

using namespace slamd;
using namespace slamd::replay;

constexpr std::size_t kMostItems = 200'000;

void require(bool holds) {
  if (!holds) std::abort();
}

struct Sums {
  std::size_t items = 0;
  double total = 0.0;
  bool operator==(const Sums&) const = default;

  void add(const ImuSample& sample) {
    require(sample.gyro_rads.allFinite() && sample.accel_mps2.allFinite());
    total += sample.gyro_rads.sum();
  }
  void add(const LidarPacket& packet) {
    require(packet.point_count <= LidarPacket::kMaxPoints && packet.azimuth_begin_cdeg < 36'000 && packet.azimuth_end_cdeg < 36'000);
    for (std::size_t i = 0; i < packet.point_count; ++i) {
      require(std::isfinite(packet.points[i].x) && packet.points[i].ring < 128 && packet.points[i].azimuth_cdeg < 36'000);
      total += packet.points[i].x;
    }
  }
  void add(const GnssFix& fix) {
    require(std::abs(fix.latitude_deg) <= 90.0 && std::abs(fix.longitude_deg) <= 180.0 && std::isfinite(fix.height_m));
    require(fix.sigma_horizontal_m >= 0.5);
  }
  void add(const WheelOdometry& wheel) { require(std::isfinite(wheel.x_m) && std::isfinite(wheel.y_m) && std::isfinite(wheel.yaw_rad)); }
  void add(const LaserScan& scan) {
    for (const LaserBeam& beam : scan.beams) require(std::isfinite(beam.angle_rad) && beam.range_m >= 0.0F && beam.range_m <= scan.range_max_m);
  }

  template <class Item>
  void drain(const std::unique_ptr<Stream<Item>>& stream) {
    HostTime last{};
    for (std::size_t i = 0; stream && i < kMostItems; ++i) {
      const Item* item = stream->next();
      if (item == nullptr) break;
      require(item->arrival >= last && to_ns(item->arrival) >= 0);
      last = item->arrival;
      ++items;
      add(*item);
    }
    if (!stream) return;
    const StreamReport report = stream->report();
    require(stream->progress() >= 0.0 && stream->progress() <= 1.0);
    total += static_cast<double>(report.items);
  }
  void drain(const Sensors& sensors) {
    drain(sensors.imu);
    drain(sensors.lidar);
    drain(sensors.gnss);
    drain(sensors.wheel);
    drain(sensors.laser);
  }
};

Sums read(const std::string& path) {
  Sums sums;
  OpenedBag opened = open_bag(path);
  if (const auto* fault = std::get_if<std::string>(&opened)) {
    require(fault->rfind(path, 0) == 0 && fault->size() < 1000);
    return sums;
  }
  if (is_own_recording(path)) sums.drain(open_own_recording(path, {}));
  const Bag& bag = *std::get<std::unique_ptr<Bag>>(opened);
  require(!list_text(path, bag, {}).empty());
  sums.drain(open_sensors(bag, {}, {}).sensors);
  return sums;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::string path = std::filesystem::temp_directory_path() / ("fuzz_bag." + std::to_string(::getpid()));
  std::ofstream{path, std::ios::binary}.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  require(read(path) == read(path));
  return 0;
}
