#pragma once
// Reads the UDP datagrams of a pcap or pcapng file one after the other (libpcap). Does not wait between packets: pacing
// belongs to whoever replays.

#include <cstdint>
#include <cstdio>
#include <memory>

#include "drivers/io/driver_stats.hpp"
#include "drivers/io/udp_packet.hpp"
#include "estimator/types/result.hpp"

struct pcap;

namespace slamd {

/// Why a captured frame gave no datagram.
enum class PcapRejection : std::uint8_t {
  kNotIp,       // ARP, LLDP, ...
  kNotUdp,      // TCP, ICMP, ...
  kFragment,    // a part of a fragmented datagram; sensors do not fragment
  kCutCapture,  // the capture kept fewer bytes than the frame had
  kBadHeader,   // lengths or versions of the headers contradict each other
  kBadStamp,    // outside what 64 bits of nanoseconds hold
  kCount
};
const char* name(PcapRejection cause);

struct PcapStats {
  std::uint64_t frames = 0;   // whole frames in the file so far
  std::uint64_t packets = 0;  // datagrams handed out
  CauseCounters<PcapRejection> rejections;
  bool damaged = false;                // the file ended inside a record or a record made no sense
  std::uint64_t unreadable_bytes = 0;  // from the last whole record to the file's end; only when damaged
};

/// One open capture file. Links: Ethernet (VLAN tags too), Linux cooked v1 and v2, raw IP, BSD loopback; IPv4 and IPv6.
/// Stamps of micro- and nanosecond files come out as nanoseconds since the epoch of the capturing host, in HostTime.
/// One thread; next() does not allocate beyond what libpcap does for a larger record than any before.
class PcapSource {
 public:
  /// Fails when the file cannot be opened, is no capture, or its link type is not one of the above.
  [[nodiscard]] static Result<PcapSource> open(const char* path);
  /// The same for an open stream, which is closed in every case.
  [[nodiscard]] static Result<PcapSource> open(std::FILE* file);

  /// The next UDP datagram, whatever its ports; null at the end. What it borrows stays valid until the next call. A
  /// file that breaks off gives all its whole packets and then ends, with stats().damaged set.
  const UdpPacket* next();

  const PcapStats& stats() const { return stats_; }
  /// For a progress bar; total is 0 when the stream has no size (a pipe).
  std::uint64_t bytes_read() const { return bytes_read_; }
  std::uint64_t bytes_total() const { return bytes_total_; }

 private:
  struct Closer {
    void operator()(pcap* handle) const;
  };
  PcapSource(pcap* handle, std::uint64_t bytes_total);
  void note_position();

  std::unique_ptr<pcap, Closer> handle_;
  int link_type_ = 0;
  bool ended_ = false;
  UdpPacket packet_;
  PcapStats stats_;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_total_ = 0;
};

}  // namespace slamd
