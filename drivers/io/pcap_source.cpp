#include "drivers/io/pcap_source.hpp"

#include <pcap/pcap.h>

#include "drivers/io/host_ns.hpp"
#include "drivers/io/ip_frame.hpp"

namespace slamd {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxSeconds = kMostHostNs / kNsPerSecond - 1;

std::uint64_t size_of(std::FILE* file) {
  if (std::fseek(file, 0, SEEK_END) != 0) return 0;
  const long size = std::ftell(file);
  std::rewind(file);
  return size > 0 ? static_cast<std::uint64_t>(size) : 0;
}

bool read_stamp(const pcap_pkthdr& header, HostTime& stamp) {
  const std::int64_t seconds = header.ts.tv_sec;
  const std::int64_t nanoseconds = header.ts.tv_usec;  // nanoseconds, as asked for when the file was opened
  if (seconds < 0 || seconds > kMaxSeconds || nanoseconds < 0 || nanoseconds >= kNsPerSecond) return false;
  stamp = from_ns<HostTime>(seconds * kNsPerSecond + nanoseconds);
  return true;
}

}  // namespace

const char* name(PcapRejection cause) {
  switch (cause) {
    case PcapRejection::kNotIp:
      return "not_ip";
    case PcapRejection::kNotUdp:
      return "not_udp";
    case PcapRejection::kFragment:
      return "fragment";
    case PcapRejection::kCutCapture:
      return "cut_capture";
    case PcapRejection::kBadHeader:
      return "bad_header";
    case PcapRejection::kBadStamp:
      return "bad_stamp";
    case PcapRejection::kCount:
      break;
  }
  return "none";
}

void PcapSource::Closer::operator()(pcap* handle) const {
  pcap_close(handle);
}

PcapSource::PcapSource(pcap* handle, std::uint64_t bytes_total)
    : handle_{handle}, link_type_{pcap_datalink(handle)}, bytes_total_{bytes_total} {
  note_position();
}

Result<PcapSource> PcapSource::open(const char* path) {
  std::FILE* file = std::fopen(path, "rbe");
  if (file == nullptr) return Error{"the capture file cannot be opened"};
  return open(file);
}

Result<PcapSource> PcapSource::open(std::FILE* file) {
  const std::uint64_t bytes_total = size_of(file);
  char text[PCAP_ERRBUF_SIZE];
  pcap* handle = pcap_fopen_offline_with_tstamp_precision(file, PCAP_TSTAMP_PRECISION_NANO, text);
  if (handle == nullptr) {
    std::fclose(file);
    return Error{"the file is neither pcap nor pcapng, or its header is damaged"};
  }
  PcapSource source{handle, bytes_total};
  if (!is_supported_link(source.link_type_)) return Error{"the capture's link type is not one that carries IP here"};
  return source;
}

const UdpPacket* PcapSource::next() {
  while (!ended_) {
    pcap_pkthdr* header = nullptr;
    const std::uint8_t* bytes = nullptr;
    const int answer = pcap_next_ex(handle_.get(), &header, &bytes);
    if (answer != 1) {
      ended_ = true;
      stats_.damaged = answer != PCAP_ERROR_BREAK;
      if (stats_.damaged && bytes_total_ > bytes_read_) stats_.unreadable_bytes = bytes_total_ - bytes_read_;
      break;
    }
    note_position();
    ++stats_.frames;
    PcapRejection cause = PcapRejection::kCutCapture;
    if (header->caplen >= header->len) cause = find_udp(link_type_, {bytes, header->caplen}, packet_);
    if (cause == PcapRejection::kCount && !read_stamp(*header, packet_.arrival)) cause = PcapRejection::kBadStamp;
    if (cause == PcapRejection::kCount) {
      ++stats_.packets;
      return &packet_;
    }
    stats_.rejections.add(cause);
  }
  return nullptr;
}

void PcapSource::note_position() {
  const long position = std::ftell(pcap_file(handle_.get()));
  if (position > 0) bytes_read_ = static_cast<std::uint64_t>(position);
}

}  // namespace slamd
