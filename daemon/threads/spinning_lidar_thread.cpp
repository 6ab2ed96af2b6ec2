#include "daemon/threads/spinning_lidar_thread.hpp"

#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/clock_health.hpp"

namespace slamd {
namespace {

constexpr Duration kStopLatency = std::chrono::milliseconds{100};

}  // namespace

void SpinningLidarThread::allow_faults() {
  constexpr WireFaultShape kShape{.delay = std::chrono::milliseconds{300}, .period = std::chrono::seconds{1},
                                  .held_reads = 512, .read_bytes = 1248};
  faults_ = std::make_unique<SensorFault<LidarValueFault>>(streams_.faults.lidar, kShape);
}

SpinningLidarThread::SpinningLidarThread(UdpSource packets, UdpSource positions, SpinningLidar lidar, Streams& streams)
    : packets_{std::move(packets)}, positions_{std::move(positions)}, lidar_{std::move(lidar)}, streams_{streams} {}

void SpinningLidarThread::run(const std::stop_token& stop) {
  // Before the system's first reader of stamps it stamps nothing: what waits was stamped now, whenever it came.
  packets_.drop_waiting();
  positions_.drop_waiting();
  while (!stop.stop_requested()) {
    receive();
    read_positions();
    now_.decoder = lidar_.stats();
    now_.side = lidar_.side_stats();
    now_.socket = packets_.stats();
    now_.clock = clock_health(lidar_.clock());
    tell();
  }
}

void SpinningLidarThread::receive() {
  const std::span<const UdpPacket> packets = packets_.receive(kStopLatency);
  const auto pass = [this](const UdpPacket& packet) {
    faults_->wire.pass(packet.payload, packet.arrival, [&](auto payload, HostTime arrival) {
      UdpPacket passed = packet;
      passed.payload = payload;
      passed.arrival = arrival;
      decode(passed);
    });
  };
  if (faults_ == nullptr) {
    for (const UdpPacket& packet : packets) decode(packet);
    return;
  }
  for (const UdpPacket& packet : packets) pass(packet);
  if (packets.empty()) pass({.payload = {}, .arrival = host_now(), .source = {}});
}

void SpinningLidarThread::decode(const UdpPacket& packet) SLAMD_NONBLOCKING {
  if (tap_ != nullptr) tap_->take(packet);
  now_.last_received = packet.arrival;
  const LidarPacket* points = lidar_.points(packet.payload, packet.arrival);
  if (points != nullptr && faults_ != nullptr) points = faults_->values.apply(*points);
  if (points == nullptr) return;
  ++now_.packets;
  now_.last_arrival = points->arrival;
  streams_.lidar.try_push(*points);
}

void SpinningLidarThread::read_positions() {
  for (const UdpPacket& packet : positions_.receive(Duration{0})) {
    if (tap_ != nullptr) tap_->take(packet);
    lidar_.side(packet.payload);
  }
}

}  // namespace slamd
