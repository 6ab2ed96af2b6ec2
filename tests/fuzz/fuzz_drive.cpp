// Any bytes as the files of a drive folder. The drive ends, its events are sound, and two readings of it are the same.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tools/slam-replay/drive/drive.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"

namespace {

using namespace slamd;
using namespace slamd::replay;

// One letter each; the input is a chain of letter, length of two bytes, content. What follows the chain is of no file.
constexpr std::array<const char*, 8> kNames{"lidar.pcap", "imu.csv", "gps.csv", "imu.pcap", "gps.pcap", "scan_shares.csv", "scan.csv",
                                          "wheel.csv"};
constexpr std::size_t kEvents = 2'000'000;  // far more than bytes can bring: a drive that does not end

void require(bool holds) {
  if (!holds) std::abort();
}

class Folder {
 public:
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "fuzz_drive.XXXXXX";
    require(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::string& path() const { return path_; }

  void fill(std::string_view chain) const {
    for (const char* name : kNames) std::filesystem::remove(path_ + "/" + name);
    while (chain.size() >= 3) {
      const auto byte = [&chain](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(chain[i])); };
      const std::string name = kNames[byte(0) % kNames.size()];
      const std::string_view content = chain.substr(3, byte(1) + 256 * byte(2));
      std::ofstream{path_ + "/" + name, std::ios::binary}.write(content.data(), static_cast<std::streamsize>(content.size()));
      chain.remove_prefix(3 + content.size());
    }
  }

 private:
  std::string path_;
};

struct Sums {
  std::size_t silences = 0, samples = 0, packets = 0, fixes = 0;
  double total = 0.0;
  bool operator==(const Sums&) const = default;
};

struct Add {
  Sums& sums;

  void operator()(std::monostate) const {}
  void operator()(const Silence&) const { ++sums.silences; }
  void operator()(const ImuSample* sample) const {
    require(sample->gyro_rads.allFinite() && sample->accel_mps2.allFinite());
    ++sums.samples;
    sums.total += sample->gyro_rads.sum();
  }
  void operator()(const LidarPacket* packet) const {
    require(packet != nullptr && packet->point_count <= LidarPacket::kMaxPoints);
    ++sums.packets;
    sums.total += packet->point_count;
  }
  void operator()(const GnssFix* fix) const {
    require(std::abs(fix->latitude_deg) <= 90.0 && std::abs(fix->longitude_deg) <= 180.0 && std::isfinite(fix->height_m));
    ++sums.fixes;
    sums.total += fix->latitude_deg;
  }
  void operator()(const WheelOdometry* wheel) const { require(std::isfinite(wheel->x_m) && std::isfinite(wheel->yaw_rad)); }
  void operator()(const LaserScan* scan) const {
    require(!scan->beams.empty() && scan->time <= scan->arrival);
    for (const LaserBeam& beam : scan->beams) {
      require(std::isfinite(beam.angle_rad) && beam.range_m >= 0.0F && beam.range_m <= scan->range_max_m && beam.time_s >= 0.0F);
      sums.total += static_cast<double>(beam.range_m);
    }
  }
};

Sums read(const std::string& folder) {
  Drive drive{open_drive_folder(folder, {}), {.silence = std::chrono::minutes{10}}};
  Sums sums;
  for (std::size_t i = 0; i < kEvents; ++i) {
    const Event event = drive.next();
    std::visit(Add{sums}, event);
    if (std::holds_alternative<std::monostate>(event)) {
      require(drive.progress() >= 0.0 && drive.progress() <= 1.0);
      return sums;
    }
  }
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  folder.fill({reinterpret_cast<const char*>(bytes), size});
  require(read(folder.path()) == read(folder.path()));
  return 0;
}
