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

TEST_F(RecorderTest, AFolderThatCannotBeMadeIsRefused) {
  EXPECT_FALSE(Recorder::open("/proc/no/such/place", ""));
}

}  // namespace
}  // namespace slamd
