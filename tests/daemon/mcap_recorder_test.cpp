#include "daemon/threads/mcap_recorder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "daemon/server/host_clock.hpp"
#include "drivers/mcap/mcap_reader.hpp"
#include "drivers/ros/messages.hpp"

namespace slamd {
namespace {

class McapRecorderTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }

  McapRecorder recorder(std::uint64_t max_bytes = std::uint64_t{1} << 30U, McapRecorder::PoseSource poses = {}) const {
    return {{.folder = folder_, .max_bytes = max_bytes, .max_length = std::chrono::hours{1}}, "lidar:\n  port: 2400\n", {}, std::move(poses)};
  }
  Bytes file(const std::string& name) const {
    std::ifstream in{folder_ + "/" + name, std::ios::binary};
    const std::vector<char> text{std::istreambuf_iterator<char>{in}, {}};
    return {text.begin(), text.end()};
  }
  static UdpPacket read(std::span<const std::uint8_t> bytes, std::int64_t at_ns) {
    return {bytes, from_ns<HostTime>(at_ns), ipv4_address(std::array<std::uint8_t, 4>{10, 0, 0, 7}), 1234, 2368};
  }

  const std::string folder_ = testing::TempDir() + "mcap_recorder_" + std::to_string(::getpid());
};

TEST_F(McapRecorderTest, ReadsComeBackWithTheirStampsPortsAndBytes) {
  McapRecorder mcap = recorder();
  ASSERT_TRUE(mcap.start({"a.mcap", 0, {}}));
  const Bytes bytes{1, 2, 3, 255};
  for (std::int64_t i = 1; i <= 3; ++i) mcap.take(RecordedWire::kLidar, read(bytes, i * 1'000'000'007));
  mcap.take(LimitedScan{from_ns<HostTime>(5), 1.0 / 3.0});
  const Result<RecordingReport> stopped = mcap.stop();
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->messages, 4U);
  const Bytes recorded = file("a.mcap");
  const auto about = find_metadata(recorded, "slamd");
  ASSERT_TRUE(about);
  const std::int64_t to_utc_ns = std::stoll(about->values.at("host_to_utc_ns"));
  McapReader reader{recorded, [](const McapChannel& channel) { return channel.topic == "/slamd/raw/lidar"; }};
  for (std::int64_t i = 1; i <= 3; ++i) {
    const McapMessage* message = reader.next();
    ASSERT_NE(message, nullptr);
    EXPECT_EQ(static_cast<std::int64_t>(message->log_time_ns) - to_utc_ns, i * 1'000'000'007);
    const auto raw = read_message<RawReadMessage>(message->bytes, RosEncoding::kCdr);
    ASSERT_TRUE(raw);
    EXPECT_EQ((Bytes{raw->bytes.begin(), raw->bytes.end()}), bytes);
    EXPECT_EQ(raw->source_port, 1234);
    EXPECT_EQ(raw->destination_port, 2368);
    EXPECT_EQ(raw->source[15], 7);
  }
  EXPECT_EQ(reader.next(), nullptr);
  ASSERT_TRUE(find_attachment(recorded, "slamd.yaml"));
}

TEST_F(McapRecorderTest, TheLimitOfBytesClosesTheFile) {
  McapRecorder mcap = recorder(1U << 20U);
  ASSERT_TRUE(mcap.start({"a.mcap", 0, {}}));
  Bytes bytes(1000);
  std::uint32_t random = 1;
  for (std::int64_t i = 0; mcap.report().state == std::string_view{"recording"}; ++i) {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((random = random * 1664525U + 1013904223U) >> 24U);
    mcap.take(RecordedWire::kGnss, read(bytes, i));
    mcap.settle(host_now());
    ASSERT_LT(i, 100'000);
  }
  EXPECT_STREQ(mcap.report().reason, "max_bytes reached");
  EXPECT_NEAR(static_cast<double>(std::filesystem::file_size(folder_ + "/a.mcap")), 1 << 20U, 1 << 17U);
  EXPECT_TRUE(read_contents(file("a.mcap")).has_summary);
  EXPECT_FALSE(mcap.stop()) << "nothing is being recorded any more";
}

TEST_F(McapRecorderTest, AWishIsNeverMoreThanTheConfiguredLimit) {
  McapRecorder mcap = recorder();
  ASSERT_TRUE(mcap.start({"a.mcap", 0, std::chrono::hours{100}}));
  mcap.settle(host_now() + std::chrono::minutes{59});
  EXPECT_STREQ(mcap.report().state, "recording");
  mcap.settle(host_now() + std::chrono::minutes{61});
  EXPECT_STREQ(mcap.report().reason, "max_s reached");
}

TEST_F(McapRecorderTest, EachNewPoseIsRecordedOnce) {
  PoseSample pose;
  pose.sequence = 1;
  McapRecorder mcap = recorder(1U << 30U, [&pose] { return std::optional{pose}; });
  ASSERT_TRUE(mcap.start({"a.mcap", 0, {}}));
  for (int i = 0; i < 10; ++i) {
    if (i % 2 == 0) ++pose.sequence;
    mcap.settle(host_now());
  }
  ASSERT_TRUE(mcap.stop());
  const Bytes recorded = file("a.mcap");
  McapReader reader{recorded, [](const McapChannel& channel) { return channel.topic == "/odom"; }};
  int poses = 0;
  while (reader.next() != nullptr) ++poses;
  EXPECT_EQ(poses, 5);
}

TEST_F(McapRecorderTest, NamesThatLeaveTheFolderSecondRecordingsAndOldFilesAreRefused) {
  McapRecorder mcap = recorder();
  for (const char* name : {"", "..", ".x.mcap", "a/b.mcap", "/tmp/x.mcap", "a b.mcap", "x.bag"}) EXPECT_FALSE(mcap.start({name, 0, {}})) << name;
  EXPECT_FALSE(mcap.stop());
  ASSERT_TRUE(mcap.start({"a.mcap", 0, {}}));
  EXPECT_FALSE(mcap.start({"b.mcap", 0, {}})) << "one at a time";
  ASSERT_TRUE(mcap.stop());
  EXPECT_FALSE(mcap.start({"a.mcap", 0, {}})) << "never written over";
}

TEST_F(McapRecorderTest, WithoutAFolderNothingIsRecordedAndThatIsSaid) {
  McapRecorder mcap{{}, "", {}, {}};
  const Result<std::string> begun = mcap.start({"a.mcap", 0, {}});
  ASSERT_FALSE(begun);
  EXPECT_STREQ(begun.reason(), "no folder for recordings is configured (recording.folder)");
}

}  // namespace
}  // namespace slamd
