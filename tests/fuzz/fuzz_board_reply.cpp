// Any bytes as a packet of the IMU board with a right checksum: read as what its kind and length say or not at all, packed again to
// the same bytes, and told in text of bounded length.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tools/imu-monitor/board_query.hpp"

namespace {

using namespace slamd;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Packet, class Text>
void check(const OpenedPacket& opened, Text text) {
  const std::optional<Packet> packet = read_packet<Packet>(opened);
  if (!packet) return;
  const std::string told = text(*packet);
  require(!told.empty() && told.size() < 1000 && told.back() == '\n');
  const auto wire = encode(*packet);
  const std::optional<OpenedPacket> again = open_packet(std::span{wire}.first(wire.size() - 1));
  require(again.has_value() && read_packet<Packet>(*again) == *packet);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  OpenedPacket opened;
  opened.size = std::min(size, opened.plain.size());
  if (opened.size <= kPacketCrcBytes) return 0;
  std::copy_n(bytes, opened.size, opened.plain.begin());
  check<Identity>(opened, monitor::identity_text);
  check<Statistics>(opened, monitor::statistics_text);
  check<SelfTestReport>(opened, monitor::self_test_text);
  return 0;
}
