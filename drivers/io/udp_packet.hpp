#pragma once
// One UDP datagram as a source hands it out: borrowed payload, who sent it, when it came. Owns nothing.

#include <array>
#include <cstdint>
#include <span>

#include "estimator/types/time.hpp"

namespace slamd {

/// IPv6, or IPv4 in its mapped form (::ffff:a.b.c.d), network order; so both compare with ==.
struct IpAddress {
  std::array<std::uint8_t, 16> bytes{};
  bool operator==(const IpAddress&) const = default;
};

/// `a`.`b`.`c`.`d` given as its four bytes in network order.
constexpr IpAddress ipv4_address(std::span<const std::uint8_t, 4> octets) {
  return {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, octets[0], octets[1], octets[2], octets[3]}};
}

struct UdpPacket {
  std::span<const std::uint8_t> payload;  // valid until the source is asked again
  HostTime arrival;
  IpAddress source;
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
};

}  // namespace slamd
