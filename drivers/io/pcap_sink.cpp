#include "drivers/io/pcap_sink.hpp"

#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdio>
#include <span>
#include <utility>

namespace slamd {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kEthernet = 14, kIp = 20, kUdp = 8, kHeaders = kEthernet + kIp + kUdp;

/// A broadcast frame with an IPv4 header of 20 bytes and a UDP header without checksum; zeros are filled in for each packet.
constexpr std::array<std::uint8_t, kHeaders> kHeaderBytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x60, 0x76, 0x88, 0x10, 0x20,
                                                          0x30, 0x08, 0x00, 0x45, 0x00, 0,    0,    0,    0,    0x40, 0x00,
                                                          0xff, 0x11, 0,    0,    0,    0,    0,    0,    255,  255,  255,
                                                          255};

void store_big(std::span<std::uint8_t> bytes, std::size_t at, std::size_t value) {
  bytes[at] = static_cast<std::uint8_t>(value >> 8U);
  bytes[at + 1] = static_cast<std::uint8_t>(value);
}

/// RFC 791 header checksum.
std::uint16_t checksum(std::span<const std::uint8_t> header) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < header.size(); i += 2) sum += static_cast<std::uint32_t>(header[i] << 8U | header[i + 1]);
  while (sum > 0xFFFF) sum = (sum & 0xFFFFU) + (sum >> 16U);
  return static_cast<std::uint16_t>(~sum);
}

}  // namespace

void PcapSink::Closer::operator()(pcap* handle) const { pcap_close(handle); }
void PcapSink::Closer::operator()(pcap_dumper* file) const { pcap_dump_close(file); }

Result<PcapSink> PcapSink::open(const char* path) {
  std::unique_ptr<pcap, Closer> handle{
      pcap_open_dead_with_tstamp_precision(DLT_EN10MB, 65'535, PCAP_TSTAMP_PRECISION_NANO)};
  if (!handle) return Error{"libpcap cannot make a capture"};
  std::unique_ptr<pcap_dumper, Closer> file{pcap_dump_open(handle.get(), path)};
  if (!file) return Error{"a capture file cannot be made there (permission? no such folder?)"};
  return PcapSink{std::move(handle), std::move(file)};
}

PcapSink::PcapSink(std::unique_ptr<pcap, Closer> handle, std::unique_ptr<pcap_dumper, Closer> file)
    : handle_{std::move(handle)}, file_{std::move(file)}, frame_{kHeaderBytes.begin(), kHeaderBytes.end()} {
  frame_.reserve(kHeaders + kMaxPayload);
}

void PcapSink::write(const UdpPacket& packet) {
  assert(packet.payload.size() <= kMaxPayload);
  frame_.resize(kHeaders);
  store_big(frame_, kEthernet + 2, kIp + kUdp + packet.payload.size());
  store_big(frame_, kEthernet + 4, count_++);
  store_big(frame_, kEthernet + 10, 0);
  std::copy(packet.source.bytes.end() - 4, packet.source.bytes.end(), frame_.begin() + kEthernet + 12);
  store_big(frame_, kEthernet + 10, checksum(std::span{frame_}.subspan(kEthernet, kIp)));
  store_big(frame_, kEthernet + kIp, packet.source_port);
  store_big(frame_, kEthernet + kIp + 2, packet.destination_port);
  store_big(frame_, kEthernet + kIp + 4, kUdp + packet.payload.size());
  frame_.insert(frame_.end(), packet.payload.begin(), packet.payload.end());
  pcap_pkthdr header{};
  header.ts.tv_sec = to_ns(packet.arrival) / kNsPerSecond;
  header.ts.tv_usec = to_ns(packet.arrival) % kNsPerSecond;  // nanoseconds at this precision
  header.caplen = header.len = static_cast<bpf_u_int32>(frame_.size());
  pcap_dump(reinterpret_cast<std::uint8_t*>(file_.get()), &header, frame_.data());
}

Result<void> PcapSink::flush() {
  const bool flushed = pcap_dump_flush(file_.get()) == 0;
  if (!flushed || std::ferror(pcap_dump_file(file_.get())) != 0) return Error{"a capture file cannot be written (disk full?)"};
  return {};
}

}  // namespace slamd
