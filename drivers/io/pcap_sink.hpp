#pragma once
// Writes datagrams to a pcap file with nanosecond stamps (libpcap), for pcap_source to read again. It makes up Ethernet and
// IP headers and decides nothing about what is worth writing.

#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/io/udp_packet.hpp"
#include "estimator/types/result.hpp"

struct pcap;
struct pcap_dumper;

namespace slamd {

/// One thread. The file is complete after finish() or the destructor.
class PcapSink {
 public:
  static constexpr std::size_t kMaxPayload = 65'493;  // with its headers the longest frame of libpcap

  /// Replaces what is there. Fails when the file cannot be made.
  [[nodiscard]] static Result<PcapSink> open(const char* path);

  /// Arrival, source, ports and payload (at most kMaxPayload bytes, IPv4) come back from PcapSource as they are.
  void write(const UdpPacket& packet);
  /// To the disk with all that was written. Fails when any of it could not be (disk full).
  Result<void> flush();

 private:
  struct Closer {
    void operator()(pcap* handle) const;
    void operator()(pcap_dumper* file) const;
  };
  PcapSink(std::unique_ptr<pcap, Closer> handle, std::unique_ptr<pcap_dumper, Closer> file);

  std::unique_ptr<pcap, Closer> handle_;
  std::unique_ptr<pcap_dumper, Closer> file_;
  std::vector<std::uint8_t> frame_;
  std::uint16_t count_ = 0;  // IP identification
};

}  // namespace slamd
