#pragma once
// UDP payloads of a VLP-16 into a pcap file with nanosecond stamps, by libpcap. Ethernet and IP headers are made up
// here.

#include <pcap/pcap.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace slamd::sim {

class PcapWriter {
 public:
  /// Throws std::runtime_error with path and reason.
  explicit PcapWriter(const std::filesystem::path& path);

  /// A broadcast from 192.168.1.201, source and destination port alike, as the sensor sends.
  void write(std::int64_t stamp_ns, std::uint16_t port, std::span<const std::uint8_t> payload);

 private:
  std::unique_ptr<pcap_t, void (*)(pcap_t*)> handle_;
  std::unique_ptr<pcap_dumper_t, void (*)(pcap_dumper_t*)> dump_;
  std::uint16_t count_ = 0;  // IP identification
};

}  // namespace slamd::sim
