#pragma once
// Sends datagrams to one host. Connectionless: nobody need listen.

#include <cstdint>
#include <span>
#include <string>

#include "tools/slam-sim/output/file_descriptor.hpp"

namespace slamd::sim {

class UdpSender {
 public:
  /// host: an IPv4 address. Throws std::runtime_error with the address and the reason.
  explicit UdpSender(const std::string& host);

  /// False when the kernel refused the datagram (full buffer, no route).
  bool send(std::uint16_t port, std::span<const std::uint8_t> payload);

 private:
  FileDescriptor socket_;
  std::uint32_t address_;  // network order
};

}  // namespace slamd::sim
