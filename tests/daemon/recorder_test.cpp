#include "daemon/threads/recorder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "daemon/threads/worker.hpp"
#include "drivers/io/pcap_source.hpp"

namespace slamd {
namespace {

class RecorderTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<Recorder> open() {
    Result<std::unique_ptr<Recorder>> recorder = Recorder::open(folder_, "lidar:\n  port: 2400\n");
    return recorder ? std::move(recorder).value() : nullptr;
  }
  std::vector<std::uint8_t> bytes_of(const char* name) const {
    std::vector<std::uint8_t> all;
    Result<PcapSource> opened = PcapSource::open((folder_ + "/" + name).c_str());
    if (!opened) return all;
    PcapSource reads = std::move(opened).value();
    while (const UdpPacket* read = reads.next()) all.insert(all.end(), read->payload.begin(), read->payload.end());
    return all;
  }

  const std::string folder_ = testing::TempDir() + "recorder_" + std::to_string(::getpid());
};

TEST_F(RecorderTest, EveryByteOfEachWireIsInItsFileWhenItHasStopped) {
  std::vector<std::uint8_t> sent(5000);
  std::iota(sent.begin(), sent.end(), std::uint8_t{0});
  const std::unique_ptr<Recorder> recorder = open();
  ASSERT_NE(recorder, nullptr);
  {
    const Worker worker{{"recorder"}, [&](const std::stop_token& stop) { recorder->run(stop); }};
    recorder->imu().take({sent, HostTime{std::chrono::seconds{5}}, {}});
    recorder->gnss().take({std::span{sent}.first(70), HostTime{std::chrono::seconds{6}}, {}});
    recorder->lidar().take({std::span{sent}.first(1206), HostTime{std::chrono::seconds{7}}, {}, 2368, 2368});
    EXPECT_TRUE(recorder->limited().try_push({HostTime{std::chrono::seconds{8}}, 1.0 / 3.0}));
  }
  EXPECT_EQ(bytes_of("imu.pcap"), sent) << "a read longer than a slot takes several";
  EXPECT_EQ(bytes_of("gps.pcap").size(), 70U);
  EXPECT_EQ(bytes_of("lidar.pcap").size(), 1206U);
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/slamd.yaml"));
  std::string header;
  std::int64_t end_ns = 0;
  double share = 0.0;
  char comma = 0;
  std::ifstream{folder_ + "/scan_shares.csv"} >> header >> end_ns >> comma >> share;
  EXPECT_EQ(end_ns, 8'000'000'000);
  EXPECT_EQ(share, 1.0 / 3.0) << "to the last bit";
  EXPECT_FALSE(recorder->failed());
}

TEST_F(RecorderTest, ATapWhoseRingIsFullDropsAndCountsAndNeverWaits) {
  WireTap tap{4};
  const std::vector<std::uint8_t> read(10);
  for (int i = 0; i < 7; ++i) tap.take({read, HostTime{}, {}});
  EXPECT_EQ(tap.counts().pushed, 4U);
  EXPECT_EQ(tap.counts().dropped, 3U);
}

TEST_F(RecorderTest, ARecordingIsNotWrittenOver) {
  ASSERT_NE(open(), nullptr);
  const auto again = Recorder::open(folder_, "");
  ASSERT_FALSE(again);
  EXPECT_STREQ(again.reason(), "there is a recording in that folder already");
}

class FlightRecorderTest : public RecorderTest {
 protected:
  std::unique_ptr<Recorder> open_flight(FlightRecorderConfig config) {
    config.folder = folder_;
    Result<std::unique_ptr<Recorder>> recorder = Recorder::open("", "lidar:\n  port: 2400\n", config);
    return recorder ? std::move(recorder).value() : nullptr;
  }
  /// One read a second of 100 bytes that say its second.
  static void feed(Recorder& recorder, std::uint8_t seconds) {
    const Worker worker{{"recorder"}, [&](const std::stop_token& stop) { recorder.run(stop); }};
    for (std::uint8_t t = 0; t < seconds; ++t) {
      const std::vector<std::uint8_t> read(100, t);
      recorder.imu().take({read, HostTime{std::chrono::seconds{t}}, {}});
    }
  }
};

TEST_F(FlightRecorderTest, ADumpHasEveryByteOfTheSpanAndItsReason) {
  const auto recorder = open_flight({});
  feed(*recorder, 40);
  const Result<std::string> path = recorder->dump("one", "a test");
  ASSERT_TRUE(path) << path.reason();
  EXPECT_EQ(*path, folder_ + "/one");
  EXPECT_EQ(bytes_of("one/imu.pcap").size(), 4000U);
  EXPECT_EQ(bytes_of("one/imu.pcap").back(), 39);
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/one/slamd.yaml"));
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/one/dump.json"));
  EXPECT_EQ(recorder->dumps(), 1U);
}

TEST_F(FlightRecorderTest, WhatIsAskedForIsWrittenByItsOwnThread) {
  const auto recorder = open_flight({});
  recorder->request_dump("asked", "a test");
  feed(*recorder, 3);
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/asked/dump.json"));
}

TEST_F(FlightRecorderTest, NamesThatLeaveTheFolderTooManyDumpsAndSecondOnesAreRefused) {
  const auto recorder = open_flight({.span = std::chrono::seconds{60}, .byte_budget = 8U << 20U, .folder = "", .max_dumps = 2});
  for (const char* name : {"", "..", ".x", "a/b", "/tmp/x", "a b"}) EXPECT_FALSE(recorder->dump(name, "")) << name;
  EXPECT_TRUE(recorder->dump("one", ""));
  EXPECT_FALSE(recorder->dump("one", "")) << "never written over";
  EXPECT_TRUE(recorder->dump("two", ""));
  EXPECT_FALSE(recorder->dump("three", "")) << "max_dumps";
  EXPECT_EQ(recorder->dumps(), 2U);
}

TEST(FlightRing, ForgetsWhatIsOlderThanItsSpanOrBeyondItsBytes) {
  FlightRing ring{std::chrono::seconds{10}, 1U << 20U};
  const std::vector<std::uint8_t> read(1000);
  for (int i = 0; i < 100; ++i) ring.add({.payload = read, .arrival = HostTime{std::chrono::milliseconds{i}}, .source = {}});
  EXPECT_GT(ring.bytes(), 100'000U);
  for (int i = 0; i < 10'000; ++i) {
    ring.add({.payload = read, .arrival = HostTime{std::chrono::milliseconds{100 + i}}, .source = {}});
    ASSERT_LE(ring.bytes(), 1U << 20U);
  }
  EXPECT_GT(ring.bytes(), (1U << 20U) - 2 * FlightRing::kChunkBytes);
  ring.add({.payload = read, .arrival = HostTime{std::chrono::seconds{100}}, .source = {}});
  EXPECT_LE(ring.bytes(), FlightRing::kChunkBytes);
}

TEST(FlightRing, ASnapshotStaysAsItIs) {
  FlightRing ring{std::chrono::seconds{10}, 1U << 20U};
  const std::vector<std::uint8_t> read(1000);
  ring.add({.payload = read, .arrival = HostTime{}, .source = {}});
  const FlightRing::Snapshot snapshot = ring.snapshot();
  const std::vector<std::uint8_t> before = snapshot.front()->bytes;
  for (int i = 0; i < 5'000; ++i) ring.add({.payload = read, .arrival = HostTime{std::chrono::milliseconds{i}}, .source = {}});
  EXPECT_EQ(snapshot.front()->bytes, before);
}

TEST_F(RecorderTest, AFolderThatCannotBeMadeIsRefused) {
  EXPECT_FALSE(Recorder::open("/proc/no/such/place", ""));
}

}  // namespace
}  // namespace slamd
