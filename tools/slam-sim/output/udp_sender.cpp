#include "tools/slam-sim/output/udp_sender.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace slamd::sim {

UdpSender::UdpSender(const std::string& host) : socket_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
  if (!socket_) throw std::runtime_error("UDP socket: " + std::string(std::strerror(errno)));
  in_addr address{};
  if (::inet_pton(AF_INET, host.c_str(), &address) != 1) throw std::runtime_error(host + ": no IPv4 address");
  address_ = address.s_addr;
  const int broadcast = 1;
  ::setsockopt(socket_.get(), SOL_SOCKET, SO_BROADCAST, &broadcast, sizeof broadcast);
}

bool UdpSender::send(std::uint16_t port, std::span<const std::uint8_t> payload) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = address_;
  to.sin_port = htons(port);
  const auto sent = ::sendto(socket_.get(), payload.data(), payload.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  return sent == static_cast<ssize_t>(payload.size());
}

}  // namespace slamd::sim
