#include "tools/slam-replay/drive/drive.hpp"

#include <limits>
#include <utility>

namespace slamd::replay {
namespace {

std::optional<PcapSource> open_capture(const std::string& path) {
  Result<PcapSource> capture = PcapSource::open(path.c_str());
  if (!capture) return std::nullopt;
  return std::move(capture).value();
}

}  // namespace

Drive::Drive(const std::string& folder, const DriveConfig& config)
    : config_{config}, pcap_{open_capture(folder + "/lidar.pcap")}, decoder_{config.vlp16}, merge_{config.merge} {
  open_imu(folder);
  if (config.with_gps) open_gps(folder);
  read_shares(folder + "/scan_shares.csv");
}

void Drive::open_imu(const std::string& folder) {
  if (std::optional<PcapSource> bytes = open_capture(folder + "/imu.pcap")) {
    imu_wire_.emplace(std::move(*bytes), config_.imu_frames);
    return;
  }
  imu_file_.open(folder + "/imu.csv");
  if (imu_file_) imu_reader_.emplace(imu_file_, config_.imu_clock);
}

void Drive::open_gps(const std::string& folder) {
  if (std::optional<PcapSource> bytes = open_capture(folder + "/gps.pcap")) {
    gps_wire_.emplace(std::move(*bytes), config_.nmea);
    return;
  }
  gps_file_.open(folder + "/gps.csv");
  if (gps_file_) gps_reader_.emplace(gps_file_, config_.nmea);
}

void Drive::read_shares(const std::string& path) {
  std::ifstream file{path};
  file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');  // the header
  std::int64_t end_ns = 0;
  char comma = ',';
  for (double share = 1.0; file >> end_ns >> comma >> share;) {
    if (share >= 0.0 && share <= 1.0) shares_[from_ns<HostTime>(end_ns)] = share;
  }
}

double Drive::scan_share(HostTime scan_end) const {
  const auto found = shares_.find(scan_end);
  return found == shares_.end() ? 1.0 : found->second;
}

Event Drive::next() {
  refill();
  EventHeads heads;
  HostTime oldest = HostTime::max();
  const auto head = [&oldest](std::optional<HostTime>& slot, HostTime arrival) {
    slot = arrival;
    oldest = std::min(oldest, arrival);
  };
  if (packet_ != nullptr) head(heads.lidar, packet_->arrival);
  if (imu_) head(heads.imu, imu_->arrival);
  if (fix_) head(heads.gnss, fix_->arrival);
  if (oldest == HostTime::max()) return std::monostate{};
  const NextEvent event = merge_.next(heads, oldest + config_.merge.hold_back);
  switch (event.kind) {
    case NextEvent::Kind::kLidar: return std::exchange(packet_, nullptr);
    case NextEvent::Kind::kImu: return *std::exchange(imu_, std::nullopt);
    case NextEvent::Kind::kGnss: return *std::exchange(fix_, std::nullopt);
    case NextEvent::Kind::kSilence:
    case NextEvent::Kind::kNone: break;
  }
  return Silence{event.time};
}

void Drive::refill() {
  if (!imu_) imu_ = next_sample();
  if (!fix_) fix_ = next_fix();
  if (packet_ == nullptr) packet_ = next_packet();
}

std::optional<ImuSample> Drive::next_sample() {
  if (imu_wire_) return imu_wire_->next();
  return imu_reader_ ? imu_reader_->next() : std::nullopt;
}

std::optional<GnssFix> Drive::next_fix() {
  if (gps_wire_) return gps_wire_->next();
  return gps_reader_ ? gps_reader_->next() : std::nullopt;
}

const LidarPacket* Drive::next_packet() {
  while (pcap_) {
    const UdpPacket* udp = pcap_->next();
    if (udp == nullptr) return nullptr;
    if (udp->destination_port != config_.lidar_port) continue;
    const LidarPacket* packet = decoder_.decode(udp->payload, udp->arrival);
    if (packet != nullptr) return packet;
  }
  return nullptr;
}

double Drive::progress() const {
  if (!pcap_ || pcap_->bytes_total() == 0) return 0.0;
  return static_cast<double>(pcap_->bytes_read()) / static_cast<double>(pcap_->bytes_total());
}

}  // namespace slamd::replay
