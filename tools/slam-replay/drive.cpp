#include "tools/slam-replay/drive.hpp"

namespace slamd::replay {

Drive::Drive(const std::string& folder, const DriveConfig& config)
    : config_{config}, imu_file_{folder + "/imu.csv"}, gps_file_{folder + "/gps.csv"}, decoder_{config.vlp16} {
  if (imu_file_) imu_reader_.emplace(imu_file_, config.imu_clock);
  if (gps_file_ && config.with_gps) gps_reader_.emplace(gps_file_, config.nmea);
  Result<PcapSource> pcap = PcapSource::open((folder + "/lidar.pcap").c_str());
  if (pcap) pcap_.emplace(std::move(pcap).value());
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
  const NextEvent event = merge_.next(heads, oldest + EventMergeConfig{}.hold_back);
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
  if (!imu_ && imu_reader_) imu_ = imu_reader_->next();
  if (!fix_ && gps_reader_) fix_ = gps_reader_->next();
  if (packet_ == nullptr) packet_ = next_packet();
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
