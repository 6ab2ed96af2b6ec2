#include "drivers/io/pcap_source.hpp"

#include <gtest/gtest.h>
#include <pcap/dlt.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
Bytes be16(unsigned v) {
  return {static_cast<std::uint8_t>(v >> 8U), static_cast<std::uint8_t>(v)};
}
Bytes le32(std::uint32_t v) {
  return {static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8U), static_cast<std::uint8_t>(v >> 16U),
          static_cast<std::uint8_t>(v >> 24U)};
}
unsigned size(const Bytes& b) {
  return static_cast<unsigned>(b.size());
}

const Bytes kPayload = {'s', 'l', 'a', 'm', 'd'};
const Bytes kMacs(12, 0x02);

Bytes udp(const Bytes& payload = kPayload) {
  return be16(443) + be16(2368) + be16(size(payload) + 8) + be16(0) + payload;
}
Bytes ipv4(const Bytes& body, unsigned fragment = 0x4000, std::uint8_t protocol = 17) {
  return Bytes{0x45, 0} + be16(20 + size(body)) + be16(7) + be16(fragment) + Bytes{64, protocol, 0, 0} +
         Bytes{192, 168, 1, 201} + Bytes{255, 255, 255, 255} + body;
}
Bytes ipv6(const Bytes& body, std::uint8_t next = 17) {
  return Bytes{0x60, 0, 0, 0} + be16(size(body)) + Bytes{next, 64} + Bytes(16, 0xFD) + Bytes(16, 0xFE) + body;
}
Bytes ethernet(const Bytes& ip, unsigned type = 0x0800) {
  return kMacs + be16(type) + ip;
}

struct Record {
  Bytes frame;
  std::uint32_t seconds = 100;
  std::uint32_t fraction = 5;
  std::optional<std::uint32_t> original_length = {};
};

Bytes pcap_file(int link, std::initializer_list<Record> records, std::uint32_t magic = 0xA1B2C3D4) {
  Bytes file =
      le32(magic) + Bytes{2, 0, 4, 0} + le32(0) + le32(0) + le32(65535) + le32(static_cast<std::uint32_t>(link));
  for (const Record& r : records) {
    file = file + le32(r.seconds) + le32(r.fraction) + le32(size(r.frame)) +
           le32(r.original_length.value_or(size(r.frame))) + r.frame;
  }
  return file;
}

/// Section, one interface with nanosecond stamps (option 9), enhanced packet blocks.
Bytes pcapng_file(int link, const Bytes& frame, std::uint64_t stamp_ns) {
  const auto block = [](std::uint32_t type, const Bytes& body) {
    return le32(type) + le32(12 + size(body)) + body + le32(12 + size(body));
  };
  Bytes padded = frame;
  padded.resize((frame.size() + 3) / 4 * 4);
  const Bytes section = block(0x0A0D0D0A, le32(0x1A2B3C4D) + Bytes{1, 0, 0, 0} + Bytes(8, 0xFF));
  const Bytes options = Bytes{9, 0, 1, 0, 9, 0, 0, 0} + le32(0);
  const Bytes interface = block(1, Bytes{static_cast<std::uint8_t>(link), 0, 0, 0} + le32(65535) + options);
  const Bytes packet =
      block(6, le32(0) + le32(static_cast<std::uint32_t>(stamp_ns >> 32U)) +
                   le32(static_cast<std::uint32_t>(stamp_ns)) + le32(size(frame)) + le32(size(frame)) + padded);
  return section + interface + packet;
}

Result<PcapSource> open(Bytes& file) {
  return PcapSource::open(fmemopen(file.data(), file.size(), "rb"));
}

/// Reads a capture of one frame; checks the payload when there is one.
PcapRejection read_one(int link, const Bytes& frame) {
  Bytes file = pcap_file(link, {{frame}});
  auto opened = open(file);
  EXPECT_TRUE(opened);
  PcapSource source = std::move(opened).value();
  const UdpPacket* packet = source.next();
  if (packet != nullptr) {
    EXPECT_EQ(Bytes(packet->payload.begin(), packet->payload.end()), kPayload);
    EXPECT_EQ(packet->destination_port, 2368);
    EXPECT_EQ(packet->source_port, 443);
    EXPECT_EQ(source.next(), nullptr);
    return PcapRejection::kCount;
  }
  for (int i = 0; i < static_cast<int>(PcapRejection::kCount); ++i) {
    if (source.stats().rejections[static_cast<PcapRejection>(i)] == 1) return static_cast<PcapRejection>(i);
  }
  ADD_FAILURE() << "neither read nor counted";
  return PcapRejection::kCount;
}

constexpr PcapRejection kRead = PcapRejection::kCount;

TEST(PcapSource, ReadsUdpFromEverySupportedLink) {
  const Bytes ip = ipv4(udp());
  const Bytes cooked = Bytes(14, 0) + be16(0x0800) + ip;
  const Bytes cooked2 = be16(0x0800) + Bytes(18, 0) + ip;
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ip)), kRead);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ip + Bytes(18, 0))), kRead);  // padded to the smallest frame
  EXPECT_EQ(read_one(DLT_EN10MB, kMacs + be16(0x8100) + be16(5) + be16(0x0800) + ip), kRead);
  EXPECT_EQ(read_one(DLT_EN10MB, kMacs + be16(0x88A8) + be16(5) + be16(0x8100) + be16(6) + be16(0x0800) + ip), kRead);
  EXPECT_EQ(read_one(DLT_LINUX_SLL, cooked), kRead);
  EXPECT_EQ(read_one(276, cooked2), kRead);  // the file's number of DLT_LINUX_SLL2
  EXPECT_EQ(read_one(101, ip), kRead);       // and of DLT_RAW
  EXPECT_EQ(read_one(101, ipv6(udp())), kRead);
  EXPECT_EQ(read_one(DLT_NULL, le32(2) + ip), kRead);
  EXPECT_EQ(read_one(108, Bytes{0, 0, 0, 2} + ip), kRead);  // DLT_LOOP
}

TEST(PcapSource, ReadsIpv6BehindExtensionHeaders) {
  const Bytes hop = Bytes{17, 0, 1, 4, 0, 0, 0, 0};
  const Bytes two = Bytes{60, 1} + Bytes(14, 0) + Bytes{17, 0} + Bytes(6, 0);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv6(udp()), 0x86DD)), kRead);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv6(hop + udp(), 0), 0x86DD)), kRead);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv6(two + udp(), 43), 0x86DD)), kRead);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv6(Bytes{17, 0, 0, 1, 0, 0, 0, 1} + udp(), 44), 0x86DD)),
            PcapRejection::kFragment);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv6(Bytes{17, 200, 0, 0}, 0), 0x86DD)), PcapRejection::kBadHeader);
}

TEST(PcapSource, SaysWhyAFrameIsNoDatagram) {
  using enum PcapRejection;
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(Bytes(28, 0), 0x0806)), kNotIp);
  EXPECT_EQ(read_one(DLT_EN10MB, Bytes(3, 0)), kNotIp);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(udp(), 0x4000, 6))), kNotUdp);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(udp(), 0x2000))), kFragment);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(udp(), 0x0010))), kFragment);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(Bytes{0x44} + Bytes(30, 0))), kBadHeader);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(be16(1) + be16(2) + be16(200) + be16(0)))), kBadHeader);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(be16(1) + be16(2) + be16(7) + be16(0)))), kBadHeader);
  EXPECT_EQ(read_one(DLT_EN10MB, ethernet(ipv4(Bytes{1, 2, 3}))), kBadHeader);
}

TEST(PcapSource, GivesSourceAddressAndStampsOfBothResolutions) {
  for (const auto& [magic, ns] : {std::pair{0xA1B2C3D4U, 5000}, {0xA1B23C4DU, 5}}) {
    Bytes file = pcap_file(DLT_EN10MB, {{ethernet(ipv4(udp()))}}, magic);
    PcapSource source = open(file).value();
    const UdpPacket* packet = source.next();
    ASSERT_NE(packet, nullptr);
    EXPECT_EQ(to_ns(packet->arrival), 100'000'000'000 + ns);
    constexpr std::uint8_t kSource[4] = {192, 168, 1, 201};
    EXPECT_EQ(packet->source, ipv4_address(kSource));
  }
}

TEST(PcapSource, ReadsPcapng) {
  constexpr std::uint64_t kStamp = 1'780'300'800'001'538'321;
  Bytes file = pcapng_file(DLT_EN10MB, ethernet(ipv4(udp())), kStamp);
  auto opened = open(file);
  ASSERT_TRUE(opened) << opened.reason();
  PcapSource source = std::move(opened).value();
  const UdpPacket* packet = source.next();
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(to_ns(packet->arrival), static_cast<std::int64_t>(kStamp));
  EXPECT_EQ(source.next(), nullptr);
  EXPECT_FALSE(source.stats().damaged);
}

TEST(PcapSource, DropsFramesThatTheCaptureCutAndStampsOutOfRange) {
  Bytes file = pcap_file(DLT_EN10MB, {{ethernet(ipv4(udp())), 1, 1, 900}, {ethernet(ipv4(udp())), 1, 2'000'000'000}});
  PcapSource source = open(file).value();
  EXPECT_EQ(source.next(), nullptr);
  EXPECT_EQ(source.stats().rejections[PcapRejection::kCutCapture], 1U);
  EXPECT_EQ(source.stats().rejections[PcapRejection::kBadStamp], 1U);
}

TEST(PcapSource, UsesTheWholePacketsOfAFileThatBreaksOffAnywhere) {
  const Bytes frame = ethernet(ipv4(udp()));
  const Bytes whole = pcap_file(DLT_EN10MB, {{frame}, {frame}});
  const std::size_t record = frame.size() + 16;
  for (std::size_t end = 24; end <= whole.size(); ++end) {
    Bytes file{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(end)};
    PcapSource source = open(file).value();
    std::size_t packets = 0;
    while (source.next() != nullptr) ++packets;
    const std::size_t rest = (end - 24) % record;
    EXPECT_EQ(packets, (end - 24) / record);
    EXPECT_EQ(source.stats().damaged, rest != 0) << end;
    EXPECT_EQ(source.stats().unreadable_bytes, rest);
    EXPECT_EQ(source.bytes_total(), end);
  }
}

TEST(PcapSource, RefusesWhatIsNoCaptureWithAReason) {
  Bytes text{'h', 'e', 'l', 'l', 'o', ' ', 'w', 'o', 'r', 'l', 'd', ' ', 'n',
             'o', ' ', 'p', 'c', 'a', 'p', '!', 1,   2,   3,   4,   5};
  EXPECT_FALSE(open(text));
  Bytes wifi = pcap_file(105, {});
  const auto opened = open(wifi);
  ASSERT_FALSE(opened);
  EXPECT_NE(std::string{opened.reason()}.find("link type"), std::string::npos);
  EXPECT_FALSE(PcapSource::open("/nonexistent/file.pcap"));
  EXPECT_FALSE(PcapSource::open("/"));
}

TEST(PcapSource, TellsItsProgressInBytes) {
  const Bytes frame = ethernet(ipv4(udp()));
  Bytes file = pcap_file(DLT_EN10MB, {{frame}, {frame}});
  PcapSource source = open(file).value();
  EXPECT_EQ(source.bytes_total(), file.size());
  EXPECT_EQ(source.bytes_read(), 24U);
  source.next();
  EXPECT_EQ(source.bytes_read(), 24 + 16 + frame.size());
  source.next();
  EXPECT_EQ(source.bytes_read(), file.size());
}

TEST(ByteReader, ReadsBothByteOrdersAndFailsForGoodAtTheEnd) {
  const Bytes bytes = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  ByteReader little{bytes};
  EXPECT_EQ(little.u16_le(), 0x0201);
  EXPECT_EQ(little.u32_le(), 0x06050403U);
  ByteReader big{bytes};
  EXPECT_EQ(big.u64_be(), 0x0102030405060708U);
  EXPECT_EQ(big.remaining(), 1U);
  EXPECT_EQ(big.u16_be(), 0);
  EXPECT_FALSE(big.ok());
  EXPECT_EQ(big.u8(), 0);
  EXPECT_TRUE(big.take(1).empty());
  ByteReader huge{bytes};
  huge.skip(static_cast<std::size_t>(-1));
  EXPECT_FALSE(huge.ok());
}

}  // namespace
}  // namespace slamd
