#include "tools/slam-replay/bag/own_recording.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "drivers/mcap/mcap_reader.hpp"
#include "drivers/ros/messages.hpp"
#include "tools/slam-replay/bag/mapped_file.hpp"
#include "tools/slam-replay/bag/mcap_bag.hpp"
#include "tools/slam-replay/drive/drive_folder.hpp"
#include "tools/slam-replay/drive/wire_streams.hpp"

namespace slamd::replay {
namespace {

/// Host time of the file's times is less by so much. Nothing: it is no recording of slamd's.
std::optional<Duration> host_to_utc(const std::string& path) {
  const std::optional<MappedFile> file = MappedFile::open(path);
  const std::optional<McapMetadata> about = file ? find_metadata(file->bytes(), "slamd") : std::nullopt;
  if (!about || !about->values.contains("host_to_utc_ns")) return std::nullopt;
  const std::string& text = about->values.at("host_to_utc_ns");
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ns);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return Duration{ns};
}

class RawReads : public ReadSource {
 public:
  RawReads(std::unique_ptr<BagCursor> cursor, std::string sensor, Duration to_utc)
      : cursor_{std::move(cursor)}, sensor_{std::move(sensor)}, to_utc_{to_utc} {}

  const UdpPacket* next() override {
    while (const BagMessage* found = cursor_->next()) {
      const std::optional<RawReadMessage> raw = read_message<RawReadMessage>(found->bytes, RosEncoding::kCdr);
      if (!raw) {
        ++unreadable_;
        continue;
      }
      read_ = {raw->bytes, found->recorded - to_utc_, {raw->source}, raw->source_port, raw->destination_port};
      return &read_;
    }
    return nullptr;
  }

  void tell(StreamReport& report) const override {
    const BagDamage damage = cursor_->damage();
    report.rejections.push_back({sensor_, "unreadable_messages", unreadable_});
    report.rejections.push_back({sensor_, "damaged_places", damage.places});
    report.rejections.push_back({sensor_, "damaged_bytes", damage.bytes});
    report.complaint = damage.first;
  }
  double progress() const override { return cursor_->progress(); }

 private:
  std::unique_ptr<BagCursor> cursor_;
  std::string sensor_;
  Duration to_utc_;
  UdpPacket read_;
  std::uint64_t unreadable_ = 0;
};

/// Null when nothing was recorded on the topic.
std::unique_ptr<BagCursor> cursor_on(const Bag& bag, const std::string& name) {
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    if (bag.topics()[i].name == name && bag.topics()[i].messages > 0) return bag.read(i);
  }
  return nullptr;
}

std::unique_ptr<ReadSource> reads_on(const Bag& bag, const std::string& name, const std::string& sensor, Duration to_utc) {
  std::unique_ptr<BagCursor> cursor = cursor_on(bag, name);
  if (cursor == nullptr) return nullptr;
  return std::make_unique<RawReads>(std::move(cursor), sensor, to_utc);
}

std::map<HostTime, double> shares_of(const Bag& bag) {
  std::map<HostTime, double> shares;
  const std::unique_ptr<BagCursor> cursor = cursor_on(bag, "/slamd/scan_share");
  while (cursor != nullptr) {
    const BagMessage* found = cursor->next();
    if (found == nullptr) break;
    const auto share = read_message<ScanShareMessage>(found->bytes, RosEncoding::kCdr);
    if (share && share->share >= 0.0 && share->share <= 1.0) shares[from_ns<HostTime>(share->scan_end_host_ns)] = share->share;
  }
  return shares;
}

}  // namespace

bool is_own_recording(const std::string& path) { return is_bag(path) && host_to_utc(path).has_value(); }

Sensors open_own_recording(const std::string& path, const DriverConfigs& drivers) {
  Sensors sensors;
  const OpenedBag opened = open_mcap(path);
  const std::optional<Duration> to_utc = host_to_utc(path);
  if (!to_utc || std::holds_alternative<std::string>(opened)) return sensors;
  const Bag& bag = *std::get<std::unique_ptr<Bag>>(opened);
  if (auto reads = reads_on(bag, "/slamd/raw/lidar", "lidar", *to_utc)) {
    if (drivers.lidar.model == LidarModel::kRplidarA2) sensors.laser = std::make_unique<RplidarWireStream>(std::move(reads), drivers.rplidar);
    else sensors.lidar = lidar_stream(std::move(reads), drivers);
  }
  if (auto reads = reads_on(bag, "/slamd/raw/wheel", "wheel", *to_utc)) {
    sensors.wheel = std::make_unique<WheelWireStream>(std::move(reads), WheelTrackConfig::defaults());
  }
  if (auto reads = reads_on(bag, "/slamd/raw/imu", "imu", *to_utc)) {
    sensors.imu = std::make_unique<ImuWireStream>(std::move(reads), drivers.imu_frames);
  }
  if (auto reads = reads_on(bag, "/slamd/raw/gps", "gps", *to_utc)) sensors.gnss = std::make_unique<GnssWireStream>(std::move(reads), drivers.nmea);
  sensors.scan_shares = shares_of(bag);
  return sensors;
}

std::optional<std::string> recorded_config(const std::string& path) {
  const std::optional<MappedFile> file = MappedFile::open(path);
  const std::optional<McapAttachment> yaml = file ? find_attachment(file->bytes(), "slamd.yaml") : std::nullopt;
  if (!yaml) return std::nullopt;
  return std::string{yaml->bytes.begin(), yaml->bytes.end()};
}

}  // namespace slamd::replay
