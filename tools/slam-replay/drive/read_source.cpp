#include "tools/slam-replay/drive/read_source.hpp"

namespace slamd::replay {

void PcapReads::tell(StreamReport& report) const {
  const PcapStats& stats = pcap_.stats();
  stats.rejections.for_each([&](const char* cause, std::uint64_t count) { report.rejections.push_back({"pcap", cause, count}); });
  report.rejections.push_back({"pcap", "unreadable_bytes", stats.unreadable_bytes});
}

double PcapReads::progress() const {
  if (pcap_.bytes_total() == 0) return 0.0;
  return static_cast<double>(pcap_.bytes_read()) / static_cast<double>(pcap_.bytes_total());
}

}  // namespace slamd::replay
