#include "drivers/io/ip_frame.hpp"

#include <pcap/dlt.h>

#include <algorithm>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr PcapRejection kFound = PcapRejection::kCount;
constexpr std::uint16_t kEtherIpv4 = 0x0800;
constexpr std::uint16_t kEtherIpv6 = 0x86DD;
constexpr std::uint8_t kProtocolUdp = 17;
constexpr int kMaxVlanTags = 4;
constexpr int kMaxIpv6Extensions = 8;

bool is_vlan_tag(std::uint16_t ether_type) {
  return ether_type == 0x8100 || ether_type == 0x88A8 || ether_type == 0x9100;
}

/// The EtherType after the link header and any VLAN tags; the reader then stands at the network header.
std::uint16_t read_ether_type(ByteReader& reader) {
  std::uint16_t type = reader.u16_be();
  for (int tag = 0; tag < kMaxVlanTags && is_vlan_tag(type); ++tag) {
    reader.skip(2);
    type = reader.u16_be();
  }
  return type;
}

/// For links that carry no EtherType: by the version in the first byte of the IP header.
std::uint16_t ether_type_of_ip(std::span<const std::uint8_t> network) {
  if (network.empty()) return 0;
  if (network[0] >> 4U == 4) return kEtherIpv4;
  return network[0] >> 4U == 6 ? kEtherIpv6 : std::uint16_t{0};
}

PcapRejection read_udp(std::span<const std::uint8_t> datagram, UdpPacket& packet) {
  constexpr std::size_t kUdpHeader = 8;
  ByteReader reader{datagram};
  packet.source_port = reader.u16_be();
  packet.destination_port = reader.u16_be();
  const std::size_t length = reader.u16_be();
  reader.skip(2);
  if (!reader.ok() || length < kUdpHeader) return PcapRejection::kBadHeader;
  packet.payload = reader.take(length - kUdpHeader);
  return reader.ok() ? kFound : PcapRejection::kBadHeader;
}

PcapRejection read_ipv4(std::span<const std::uint8_t> network, UdpPacket& packet) {
  ByteReader reader{network};
  const std::uint8_t version_length = reader.u8();
  const std::size_t header = 4U * (version_length & 0x0FU);
  reader.skip(1);
  const std::size_t total = reader.u16_be();
  reader.skip(2);
  const std::uint16_t fragment = reader.u16_be();
  reader.skip(1);
  const std::uint8_t protocol = reader.u8();
  reader.skip(2);
  const auto source = reader.take(4);
  if (!reader.ok() || version_length >> 4U != 4 || header < 20 || total < header || total > network.size()) {
    return PcapRejection::kBadHeader;
  }
  if ((fragment & 0x3FFFU) != 0) return PcapRejection::kFragment;  // more-fragments flag or an offset
  if (protocol != kProtocolUdp) return PcapRejection::kNotUdp;
  packet.source = ipv4_address(source.first<4>());
  return read_udp(network.subspan(header, total - header), packet);
}

/// Follows the extension headers (RFC 8200 section 4) from `next` to UDP; the reader then stands at the UDP header.
PcapRejection skip_ipv6_extensions(std::uint8_t next, ByteReader& reader) {
  constexpr std::uint8_t kHopByHop = 0, kRouting = 43, kFragment = 44, kDestination = 60;
  for (int i = 0; i < kMaxIpv6Extensions && next != kProtocolUdp; ++i) {
    if (next == kFragment) return PcapRejection::kFragment;
    if (next != kHopByHop && next != kRouting && next != kDestination) return PcapRejection::kNotUdp;
    next = reader.u8();
    reader.skip(6U + 8U * reader.u8());
    if (!reader.ok()) return PcapRejection::kBadHeader;
  }
  return next == kProtocolUdp ? kFound : PcapRejection::kNotUdp;
}

PcapRejection read_ipv6(std::span<const std::uint8_t> network, UdpPacket& packet) {
  ByteReader reader{network};
  const std::uint8_t version = reader.u8() >> 4U;
  reader.skip(3);
  const std::size_t length = reader.u16_be();
  const std::uint8_t next = reader.u8();
  reader.skip(1);
  const auto source = reader.take(16);
  reader.skip(16);
  if (!reader.ok() || version != 6 || length > reader.remaining()) return PcapRejection::kBadHeader;
  std::copy(source.begin(), source.end(), packet.source.bytes.begin());
  ByteReader body{reader.take(length)};
  if (const PcapRejection cause = skip_ipv6_extensions(next, body); cause != kFound) return cause;
  return read_udp(body.take(body.remaining()), packet);
}

/// Reads the link header; the reader then stands at the network header. 0 when the frame is too short or not IP.
std::uint16_t read_link(int link_type, std::span<const std::uint8_t> frame, ByteReader& reader) {
  switch (link_type) {
    case DLT_EN10MB:
      reader.skip(12);
      return read_ether_type(reader);
    case DLT_LINUX_SLL:
      reader.skip(14);
      return read_ether_type(reader);
    case DLT_LINUX_SLL2: {
      const std::uint16_t type = reader.u16_be();
      reader.skip(18);
      return type;
    }
    case DLT_NULL:
    case DLT_LOOP:  // an address family whose number differs between systems: the IP version tells as well
      reader.skip(4);
      return reader.ok() ? ether_type_of_ip(frame.subspan(4)) : std::uint16_t{0};
    default:
      return ether_type_of_ip(frame);
  }
}

}  // namespace

bool is_supported_link(int link_type) {
  constexpr int kLinks[] = {DLT_EN10MB, DLT_LINUX_SLL, DLT_LINUX_SLL2, DLT_NULL, DLT_LOOP, DLT_RAW, DLT_IPV4, DLT_IPV6};
  return std::find(std::begin(kLinks), std::end(kLinks), link_type) != std::end(kLinks);
}

PcapRejection find_udp(int link_type, std::span<const std::uint8_t> frame, UdpPacket& packet) {
  ByteReader reader{frame};
  const std::uint16_t ether_type = read_link(link_type, frame, reader);
  const auto network = reader.take(reader.remaining());
  if (ether_type == kEtherIpv4) return read_ipv4(network, packet);
  if (ether_type == kEtherIpv6) return read_ipv6(network, packet);
  return PcapRejection::kNotIp;
}

}  // namespace slamd
