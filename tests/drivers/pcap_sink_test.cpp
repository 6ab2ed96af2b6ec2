#include "drivers/io/pcap_sink.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/io/pcap_source.hpp"

namespace slamd {
namespace {

constexpr std::array<std::uint8_t, 4> kSensor{192, 168, 1, 201};

TEST(PcapSink, WhatIsWrittenIsReadAgainToTheNanosecond) {
  const std::string path = testing::TempDir() + "pcap_sink_" + std::to_string(::getpid());
  std::vector<std::uint8_t> bytes(PcapSink::kMaxPayload);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  const std::size_t sizes[] = {0, 1, 33, 1206, PcapSink::kMaxPayload};
  {
    Result<PcapSink> made = PcapSink::open(path.c_str());
    ASSERT_TRUE(made) << made.reason();
    PcapSink sink = std::move(made).value();
    for (const std::size_t size : sizes) {
      const auto stamp = from_ns<HostTime>(1'234'567'890'123 + static_cast<std::int64_t>(size));
      sink.write({std::span{bytes}.first(size), stamp, ipv4_address(kSensor), 443, 2368});
    }
    EXPECT_TRUE(sink.flush());
  }
  Result<PcapSource> source = PcapSource::open(path.c_str());
  ASSERT_TRUE(source) << source.reason();
  PcapSource reader = std::move(source).value();
  for (const std::size_t size : sizes) {
    const UdpPacket* packet = reader.next();
    ASSERT_NE(packet, nullptr) << size;
    EXPECT_EQ(to_ns(packet->arrival), 1'234'567'890'123 + static_cast<std::int64_t>(size));
    EXPECT_EQ(packet->source, ipv4_address(kSensor));
    EXPECT_EQ(packet->source_port, 443);
    EXPECT_EQ(packet->destination_port, 2368);
    ASSERT_EQ(packet->payload.size(), size);
    EXPECT_TRUE(std::equal(packet->payload.begin(), packet->payload.end(), bytes.begin()));
  }
  EXPECT_EQ(reader.next(), nullptr);
  EXPECT_FALSE(reader.stats().damaged);
  std::filesystem::remove(path);
}

TEST(PcapSink, APlaceThatCannotBeWrittenIsRefused) {
  EXPECT_FALSE(PcapSink::open("/proc/no/such/place.pcap"));
}

TEST(PcapSink, AFullDiskIsTold) {
  Result<PcapSink> made = PcapSink::open("/dev/full");
  if (!made) GTEST_SKIP() << "no /dev/full here";
  PcapSink sink = std::move(made).value();
  const std::vector<std::uint8_t> bytes(1206);
  for (int i = 0; i < 10; ++i) sink.write({bytes, HostTime{}, ipv4_address(kSensor), 1, 1});
  EXPECT_FALSE(sink.flush());
}

}  // namespace
}  // namespace slamd
