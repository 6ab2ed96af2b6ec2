#include "tools/slam-sim/output/pcap_writer.hpp"

#include <stdexcept>
#include <vector>

namespace slamd::sim {
namespace {

constexpr std::size_t kEthernet = 14, kIp = 20, kUdp = 8;

void store_big(std::span<std::uint8_t> bytes, std::size_t at, std::size_t value) {
  bytes[at] = static_cast<std::uint8_t>(value >> 8);
  bytes[at + 1] = static_cast<std::uint8_t>(value);
}

/// RFC 791 header checksum.
std::uint16_t checksum(std::span<const std::uint8_t> header) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < header.size(); i += 2) sum += static_cast<std::uint32_t>(header[i] << 8 | header[i + 1]);
  while (sum > 0xFFFF) sum = (sum & 0xFFFF) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

}  // namespace

PcapWriter::PcapWriter(const std::filesystem::path& path)
    : handle_{pcap_open_dead_with_tstamp_precision(DLT_EN10MB, 65535, PCAP_TSTAMP_PRECISION_NANO), &pcap_close},
      dump_{pcap_dump_open(handle_.get(), path.c_str()), &pcap_dump_close} {
  if (!dump_) throw std::runtime_error(path.string() + ": " + pcap_geterr(handle_.get()));
}

void PcapWriter::write(std::int64_t stamp_ns, std::uint16_t port, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> frame{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x60, 0x76, 0x88, 0x10, 0x20, 0x30,
                                  0x08, 0x00, 0x45, 0x00, 0,    0,    0,    0,    0x40, 0x00, 0xff, 0x11,
                                  0,    0,    192,  168,  1,    201,  255,  255,  255,  255};
  frame.resize(kEthernet + kIp + kUdp);
  store_big(frame, kEthernet + 2, kIp + kUdp + payload.size());
  store_big(frame, kEthernet + 4, count_++);
  store_big(frame, kEthernet + 10, checksum(std::span{frame}.subspan(kEthernet, kIp)));
  store_big(frame, kEthernet + kIp, port);
  store_big(frame, kEthernet + kIp + 2, port);
  store_big(frame, kEthernet + kIp + 4, kUdp + payload.size());
  frame.insert(frame.end(), payload.begin(), payload.end());
  pcap_pkthdr header{};
  header.ts.tv_sec = stamp_ns / 1'000'000'000;
  header.ts.tv_usec = stamp_ns % 1'000'000'000;  // nanoseconds at this precision
  header.caplen = header.len = static_cast<bpf_u_int32>(frame.size());
  pcap_dump(reinterpret_cast<std::uint8_t*>(dump_.get()), &header, frame.data());
}

}  // namespace slamd::sim
