// Any bytes as a capture file. Every frame is handed out or counted, and a datagram wrapped anew is found unchanged.
#include <pcap/dlt.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/io/ip_frame.hpp"
#include "drivers/io/pcap_source.hpp"

namespace {

using namespace slamd;
using Bytes = std::vector<std::uint8_t>;

void require(bool holds) {
  if (!holds) std::abort();
}

void append16(Bytes& to, std::size_t value) {
  to.push_back(static_cast<std::uint8_t>(value >> 8U));
  to.push_back(static_cast<std::uint8_t>(value));
}

/// Ethernet, a VLAN tag, IPv4, UDP.
Bytes wrap(const UdpPacket& packet) {
  Bytes frame(12, 0);
  for (const std::size_t value : {0x8100, 1, 0x0800, 0x4500}) append16(frame, value);
  append16(frame, 28 + packet.payload.size());
  for (const std::size_t value : {0, 0x4000, 0x4011, 0}) append16(frame, value);
  frame.insert(frame.end(), packet.source.bytes.begin() + 12, packet.source.bytes.end());
  frame.insert(frame.end(), 4, 0xFF);
  append16(frame, packet.source_port);
  append16(frame, packet.destination_port);
  append16(frame, 8 + packet.payload.size());
  append16(frame, 0);
  frame.insert(frame.end(), packet.payload.begin(), packet.payload.end());
  return frame;
}

void check_round_trip(const UdpPacket& packet) {
  if (packet.payload.size() > 65507) return;
  const Bytes frame = wrap(packet);
  UdpPacket again;
  require(find_udp(DLT_EN10MB, frame, again) == PcapRejection::kCount);
  require(std::equal(again.payload.begin(), again.payload.end(), packet.payload.begin(), packet.payload.end()));
  require(again.source_port == packet.source_port && again.destination_port == packet.destination_port);
}

/// The bytes as one frame of every link, past libpcap's own checks.
void check_as_frame(std::span<const std::uint8_t> bytes) {
  for (const int link : {DLT_EN10MB, DLT_LINUX_SLL, DLT_LINUX_SLL2, DLT_NULL, DLT_RAW}) {
    UdpPacket packet;
    if (find_udp(link, bytes, packet) != PcapRejection::kCount) continue;
    require(packet.payload.data() >= bytes.data());
    require(packet.payload.data() + packet.payload.size() <= bytes.data() + bytes.size());
    check_round_trip(packet);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  check_as_frame({bytes, size});
  if (size == 0) return 0;
  Bytes file{bytes, bytes + size};
  std::FILE* stream = fmemopen(file.data(), file.size(), "rb");
  require(stream != nullptr);
  auto opened = PcapSource::open(stream);
  if (!opened) return 0;
  PcapSource source = std::move(opened).value();
  while (const UdpPacket* packet = source.next()) check_round_trip(*packet);
  require(source.next() == nullptr);
  require(source.stats().frames == source.stats().packets + source.stats().rejections.total());
  require(source.bytes_total() == size && source.bytes_read() + source.stats().unreadable_bytes <= size);
  return 0;
}
