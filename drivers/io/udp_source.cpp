#include "drivers/io/udp_source.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "drivers/io/receive_clock.hpp"

namespace slamd {
namespace {

constexpr std::size_t kControlBytes = 128;  // a stamp and a drop counter

struct Slot {
  alignas(cmsghdr) std::array<std::uint8_t, kControlBytes> control;
  std::array<std::uint8_t, UdpSource::kMaxPayload> payload;
  sockaddr_in source;
  iovec part;
};

struct Ancillary {
  std::optional<std::int64_t> realtime_ns;
  std::optional<std::uint32_t> overflow_total;
};

Ancillary read_ancillary(msghdr& header) {
  Ancillary found;
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
      found.realtime_ns = std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec;
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(c), sizeof total);
      found.overflow_total = total;
    }
  }
  return found;
}

bool enable(int socket, int option) {
  const int on = 1;
  return setsockopt(socket, SOL_SOCKET, option, &on, sizeof on) == 0;
}

/// The forced form needs CAP_NET_ADMIN; the other one is capped by net.core.rmem_max, which only costs reserve.
void ask_for_buffer(int socket, int bytes) {
  if (setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) == 0) return;
  (void)setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

}  // namespace

struct UdpSource::Batch {
  explicit Batch(int fd) : socket{fd} {}
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;
  ~Batch() { close(socket); }

  void arm(std::size_t i);
  void accept(std::size_t i);
  bool is_foreign(const sockaddr_in& sender) const;
  bool wait(Duration timeout);

  int socket;
  std::uint16_t port = 0;
  std::optional<in_addr> only_source;
  in_port_t only_source_port = 0;  // network order; 0: any
  ReceiveClock clock;
  HostTime newest_arrival{HostTime::min()};
  std::uint32_t overflow_total = 0;
  UdpStats stats;
  std::array<mmsghdr, kBatch> headers{};
  std::array<Slot, kBatch> slots{};
  std::array<UdpPacket, kBatch> packets{};
  std::size_t packet_count = 0;
};

void UdpSource::Batch::arm(std::size_t i) {
  Slot& slot = slots[i];
  slot.part = {slot.payload.data(), slot.payload.size()};
  msghdr& header = headers[i].msg_hdr;
  header = {};
  header.msg_name = &slot.source;
  header.msg_namelen = sizeof slot.source;
  header.msg_iov = &slot.part;
  header.msg_iovlen = 1;
  header.msg_control = slot.control.data();
  header.msg_controllen = slot.control.size();
}

bool UdpSource::Batch::is_foreign(const sockaddr_in& sender) const {
  if (only_source && sender.sin_addr.s_addr != only_source->s_addr) return true;
  return only_source_port != 0 && sender.sin_port != only_source_port;
}

void UdpSource::Batch::accept(std::size_t i) {
  msghdr& header = headers[i].msg_hdr;
  const Slot& slot = slots[i];
  const Ancillary ancillary = read_ancillary(header);
  if (ancillary.overflow_total) {
    stats.overflowed +=
        *ancillary.overflow_total - overflow_total;  // the kernel's counter wraps at 32 bits, as this does
    overflow_total = *ancillary.overflow_total;
  }
  if (is_foreign(slot.source)) {
    ++stats.foreign;
    return;
  }
  if ((header.msg_flags & MSG_TRUNC) != 0) {
    ++stats.oversized;
    return;
  }
  std::optional<HostTime> arrival;
  if (ancillary.realtime_ns) arrival = clock.arrival(*ancillary.realtime_ns);
  if (!arrival) ++stats.unstamped;
  newest_arrival =
      std::max(newest_arrival, arrival.value_or(clock.now()));  // several receive queues may disagree by a little

  const auto octets = std::bit_cast<std::array<std::uint8_t, 4>>(slot.source.sin_addr.s_addr);
  packets[packet_count++] = {std::span{slot.payload.data(), headers[i].msg_len}, newest_arrival, ipv4_address(octets),
                             ntohs(slot.source.sin_port), port};
  ++stats.packets;
}

bool UdpSource::Batch::wait(Duration timeout) {
  pollfd waiting{socket, POLLIN, 0};
  timeout = std::max(timeout, Duration::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const timespec limit{seconds.count(), (timeout - seconds).count()};
  return ppoll(&waiting, 1, &limit, nullptr) > 0;
}

Result<UdpSource> UdpSource::open(const UdpSourceConfig& config) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(config.port);
  if (inet_pton(AF_INET, config.bind_address.c_str(), &address.sin_addr) != 1) return Error{"bad bind address"};
  in_addr only_source{};
  const bool filtered = !config.source_address.empty();
  if (filtered && inet_pton(AF_INET, config.source_address.c_str(), &only_source) != 1) {
    return Error{"bad source address"};
  }

  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return Error{"no socket to be had"};
  auto batch = std::make_unique<Batch>(fd);
  if (filtered) batch->only_source = only_source;
  batch->only_source_port = htons(config.source_port);
  ask_for_buffer(fd, config.receive_buffer_bytes);
  if (!enable(fd, SO_TIMESTAMPNS)) return Error{"the kernel gives no receive stamps"};
  if (!enable(fd, SO_RXQ_OVFL)) return Error{"the kernel does not count receive overflows"};
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  if (bind(fd, generic, sizeof address) != 0) {
    return Error{errno == EADDRINUSE ? "the UDP port is in use"
                                     : "cannot bind: no such address here, or no permission"};
  }
  socklen_t length = sizeof address;
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &length);
  batch->port = ntohs(address.sin_port);
  return UdpSource{std::move(batch)};
}

UdpSource::UdpSource(std::unique_ptr<Batch> batch) : batch_{std::move(batch)} {}
UdpSource::UdpSource(UdpSource&&) noexcept = default;
UdpSource& UdpSource::operator=(UdpSource&&) noexcept = default;
UdpSource::~UdpSource() = default;

std::span<const UdpPacket> UdpSource::receive(Duration timeout) {
  Batch& b = *batch_;
  b.packet_count = 0;
  if (!b.wait(timeout)) return {};
  for (std::size_t i = 0; i < kBatch; ++i) b.arm(i);
  const int count = recvmmsg(b.socket, b.headers.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (count < 0) {
    if (errno != EAGAIN && errno != EINTR) ++b.stats.errors;
    return {};
  }
  b.clock.sample();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) b.accept(i);
  return {b.packets.data(), b.packet_count};
}

void UdpSource::drop_waiting() {
  constexpr int kMost = 100'000;  // more than a receive buffer holds: a sender that never pauses must not keep us here
  char byte = 0;
  for (int i = 0; i < kMost && recv(batch_->socket, &byte, sizeof byte, MSG_DONTWAIT) >= 0; ++i) {
  }
}

const UdpStats& UdpSource::stats() const {
  return batch_->stats;
}
std::uint16_t UdpSource::port() const {
  return batch_->port;
}

int UdpSource::receive_buffer_bytes() const {
  int bytes = 0;
  socklen_t length = sizeof bytes;
  getsockopt(batch_->socket, SOL_SOCKET, SO_RCVBUF, &bytes, &length);
  return bytes;
}

}  // namespace slamd
