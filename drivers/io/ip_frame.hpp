#pragma once
// Finds the UDP datagram inside a captured link-layer frame. Pure functions over bytes; reassembles nothing and checks
// no checksum (capture files often hold offloaded ones).

#include <cstdint>
#include <span>

#include "drivers/io/pcap_source.hpp"
#include "drivers/io/udp_packet.hpp"

namespace slamd {

/// True when `link_type` (a DLT_ value of libpcap) is one that find_udp understands.
bool is_supported_link(int link_type);

/// Fills everything of `packet` but its arrival from a whole frame of that link type. Returns kCount when it holds a
/// datagram, else why not (then `packet` is unspecified).
PcapRejection find_udp(int link_type, std::span<const std::uint8_t> frame, UdpPacket& packet);

}  // namespace slamd
