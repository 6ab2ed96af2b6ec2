#pragma once
// The reads of one device as they were recorded: bytes with the stamp of their arrival. It parses nothing.

#include <utility>

#include "drivers/io/pcap_source.hpp"
#include "tools/slam-replay/drive/stream.hpp"

namespace slamd::replay {

class ReadSource {
 public:
  virtual ~ReadSource() = default;
  /// The next read, valid until the next call; null at the end.
  virtual const UdpPacket* next() = 0;
  /// Adds what was refused here.
  virtual void tell(StreamReport& report) const = 0;
  /// Share of the recording read so far, 0..1.
  virtual double progress() const = 0;
};

/// Of a capture file.
class PcapReads : public ReadSource {
 public:
  explicit PcapReads(PcapSource pcap) : pcap_{std::move(pcap)} {}

  const UdpPacket* next() override { return pcap_.next(); }
  void tell(StreamReport& report) const override;
  double progress() const override;

 private:
  PcapSource pcap_;
};

/// Of a capture file, only the datagrams to one port.
class PortReads : public PcapReads {
 public:
  PortReads(PcapSource pcap, std::uint16_t port) : PcapReads{std::move(pcap)}, port_{port} {}

  const UdpPacket* next() override {
    const UdpPacket* read = PcapReads::next();
    while (read != nullptr && read->destination_port != port_) read = PcapReads::next();
    return read;
  }

 private:
  std::uint16_t port_;
};

}  // namespace slamd::replay
