#include "daemon/threads/lidar_thread.hpp"

#include <utility>

namespace slamd {
namespace {

constexpr Duration kStopLatency = std::chrono::milliseconds{100};

}  // namespace

Result<LidarThread> LidarThread::open(const LidarThreadConfig& config, const Vlp16Config& decoder, Streams& streams) {
  UdpSourceConfig source{config.bind_address, config.port, config.source_address, config.source_port,
                         config.receive_buffer_bytes};
  Result<UdpSource> packets = UdpSource::open(source);
  if (!packets) return Error{packets.reason()};
  source.port = config.position_port;
  source.source_port = config.position_source_port;
  Result<UdpSource> positions = UdpSource::open(source);
  if (!positions) return Error{positions.reason()};
  return LidarThread{std::move(packets).value(), std::move(positions).value(), decoder, streams};
}

LidarThread::LidarThread(UdpSource packets, UdpSource positions, const Vlp16Config& decoder, Streams& streams)
    : packets_{std::move(packets)},
      positions_{std::move(positions)},
      decoder_{decoder},
      streams_{streams},
      report_{std::make_unique<LatestValue<LidarReport>>()} {}

void LidarThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    decode(packets_.receive(kStopLatency));
    read_positions();
    now_.decoder = decoder_.stats();
    now_.socket = packets_.stats();
    now_.last_rejection = decoder_.last_rejection();
    now_.clock_locked = decoder_.clock().locked();
    now_.rotation_rpm = decoder_.rotation_rpm();
    report_->store(now_);
  }
}

void LidarThread::decode(std::span<const UdpPacket> packets) {
  for (const UdpPacket& packet : packets) {
    if (tap_ != nullptr) tap_->take(packet);
    now_.last_received = packet.arrival;
    const LidarPacket* points = decoder_.decode(packet.payload, packet.arrival);
    if (points == nullptr) continue;
    now_.last_arrival = points->arrival;
    streams_.lidar.try_push(*points);
  }
}

void LidarThread::read_positions() {
  for (const UdpPacket& packet : positions_.receive(Duration{0})) {
    if (tap_ != nullptr) tap_->take(packet);
    const Result<Vlp16Position> position = parse_vlp16_position(packet.payload);
    if (!position) continue;
    now_.pps = position->pps;
    ++now_.position_packets;
  }
}

}  // namespace slamd
