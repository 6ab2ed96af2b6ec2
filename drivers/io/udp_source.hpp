#pragma once
// Receives UDP datagrams of one port in batches, each with the kernel's receive stamp in host time. It runs no thread
// and understands no payload. IPv4 only: the sensors it is for speak nothing else.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/io/udp_packet.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

struct UdpSourceConfig {
  std::string bind_address = "0.0.0.0";  // of the interface; 0.0.0.0 also takes broadcasts
  std::uint16_t port = 2368;             // 0 = any free one, see UdpSource::port()
  std::string source_address;            // when not empty, datagrams of others are dropped and counted
  std::uint16_t source_port = 0;         // likewise unless 0: of the sender
  int receive_buffer_bytes = 4 << 20;    // about 2.5 s of VLP-16 packets with the kernel's overhead
};

struct UdpStats {
  std::uint64_t packets = 0;     // handed out
  std::uint64_t foreign = 0;     // dropped: not from the configured source address or port
  std::uint64_t oversized = 0;   // dropped: longer than any sensor's packet
  std::uint64_t overflowed = 0;  // dropped by the kernel because we were late (SO_RXQ_OVFL)
  std::uint64_t unstamped = 0;   // arrival is the time of the call: no kernel stamp, or one that a clock step spoiled
  std::uint64_t errors = 0;      // receive calls that failed
};

/// One bound socket. One thread; receive() allocates nothing. Kernel stamps are CLOCK_REALTIME; they are carried over
/// to CLOCK_MONOTONIC by the offset between the two, read at the same call. Both clocks are slewed alike, so the offset
/// only changes when the wall clock is set; datagrams that waited across such a step get the time of the call instead.
class UdpSource {
 public:
  static constexpr std::size_t kBatch = 32;
  static constexpr std::size_t kMaxPayload = 2048;

  /// Binds. Fails with the step that failed (bad address, port in use, ...).
  [[nodiscard]] static Result<UdpSource> open(const UdpSourceConfig& config);
  UdpSource(UdpSource&&) noexcept;
  UdpSource& operator=(UdpSource&&) noexcept;
  ~UdpSource();

  /// Waits at most `timeout` for the first datagram, then takes what is there, at most kBatch. Empty after the timeout,
  /// or when all were dropped. In order of reception, arrivals never go back; what they borrow is valid until the next
  /// call.
  std::span<const UdpPacket> receive(Duration timeout);

  /// Throws away what waits in the socket, uncounted: of what came before a thread reads, no one knows when.
  void drop_waiting();

  const UdpStats& stats() const;
  std::uint16_t port() const;
  /// What the kernel granted; less than asked for without CAP_NET_ADMIN and with a low net.core.rmem_max.
  int receive_buffer_bytes() const;

 private:
  struct Batch;
  explicit UdpSource(std::unique_ptr<Batch> batch);
  std::unique_ptr<Batch> batch_;
};

}  // namespace slamd
