// The containers: what stands in a bag comes out of it, and of a damaged one nothing else.
#include "tools/slam-replay/bag/bag.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "drivers/mcap/mcap_writer.hpp"
#include "drivers/ros/message_writer.hpp"
#include "tests/support/bag_files.hpp"

namespace slamd::replay {
namespace {

using test::SentMessage;
using Heard = std::vector<std::pair<std::int64_t, std::vector<std::uint8_t>>>;

constexpr std::int64_t kBegin_ns = 1'700'000'000'000'000'000;

/// Two topics, messages of 20 bytes and more.
std::vector<SentMessage> messages(int count, const char* type) {
  std::vector<SentMessage> all;
  for (int i = 0; i < count; ++i) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(20 + i), static_cast<std::uint8_t>(i));
    all.push_back({i % 3 == 0 ? "/gps" : "/imu", type, kBegin_ns + i * 1'000'000, bytes});
  }
  return all;
}

std::size_t topic_named(const Bag& bag, const std::string& name) {
  const auto found = std::find_if(bag.topics().begin(), bag.topics().end(), [&](const Topic& topic) { return topic.name == name; });
  return static_cast<std::size_t>(found - bag.topics().begin());
}

Heard hear(BagCursor& cursor) {
  Heard heard;
  while (const BagMessage* message = cursor.next()) {
    heard.emplace_back(to_ns(message->recorded), std::vector<std::uint8_t>{message->bytes.begin(), message->bytes.end()});
  }
  return heard;
}

Heard sent_on(const std::vector<SentMessage>& messages, const std::string& topic) {
  Heard sent;
  for (const SentMessage& m : messages) {
    if (m.topic == topic) sent.emplace_back(m.time_ns, m.bytes);
  }
  return sent;
}

class BagTest : public testing::Test {
 protected:
  BagTest() { std::filesystem::create_directories(folder_); }
  ~BagTest() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  static std::string text_of(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
  }
  static std::unique_ptr<Bag> open(const std::string& path) {
    OpenedBag opened = open_bag(path);
    if (const auto* fault = std::get_if<std::string>(&opened)) {
      ADD_FAILURE() << *fault;
      return nullptr;
    }
    return std::move(std::get<std::unique_ptr<Bag>>(opened));
  }
  static std::string fault_of(const std::string& path) {
    const OpenedBag opened = open_bag(path);
    const auto* fault = std::get_if<std::string>(&opened);
    return fault == nullptr ? "" : *fault;
  }

  void make_mcap(const std::string& name, const std::vector<SentMessage>& sent) const {
    McapWriter writer = McapWriter::open(path(name), "ros2", "test").value();
    const std::uint16_t schema = writer.add_schema(sent.front().type, "ros2msg", "");
    const std::map<std::string, std::uint16_t> channels{{"/gps", writer.add_channel(schema, "/gps", "cdr")},
                                                        {"/imu", writer.add_channel(schema, "/imu", "cdr")}};
    for (const SentMessage& m : sent) writer.write(channels.at(m.topic), static_cast<std::uint64_t>(m.time_ns), m.bytes);
    ASSERT_TRUE(writer.finish());
  }

  void expect_holds(const std::string& bag_path, const std::vector<SentMessage>& sent, const char* type) {
    const std::unique_ptr<Bag> bag = open(bag_path);
    ASSERT_NE(bag, nullptr);
    ASSERT_EQ(bag->topics().size(), 2U);
    for (const char* name : {"/gps", "/imu"}) {
      const std::size_t topic = topic_named(*bag, name);
      ASSERT_LT(topic, 2U);
      EXPECT_EQ(bag->topics()[topic].type, type);
      EXPECT_EQ(bag->topics()[topic].messages, sent_on(sent, name).size());
      const std::unique_ptr<BagCursor> cursor = bag->read(topic);
      EXPECT_EQ(hear(*cursor), sent_on(sent, name));
      EXPECT_EQ(cursor->damage().places, 0U) << cursor->damage().first;
      EXPECT_NEAR(cursor->progress(), 1.0, 0.01);
    }
  }

  /// Whatever comes out of the file was sent on that topic. How many messages came out of all topics.
  std::size_t expect_nothing_else(const std::string& bag_path, const std::vector<SentMessage>& sent, const std::string& what) {
    OpenedBag opened = open_bag(bag_path);
    if (std::holds_alternative<std::string>(opened)) return 0;
    const Bag& bag = *std::get<std::unique_ptr<Bag>>(opened);
    std::size_t count = 0;
    for (std::size_t topic = 0; topic < bag.topics().size(); ++topic) {
      const std::unique_ptr<BagCursor> cursor = bag.read(topic);
      const Heard truth = sent_on(sent, bag.topics()[topic].name);
      for (const auto& one : hear(*cursor)) {
        ++count;
        if (std::find(truth.begin(), truth.end(), one) == truth.end()) ADD_FAILURE() << what << ": a message that was never sent";
      }
    }
    return count;
  }

  const std::string folder_ = testing::TempDir() + "bag_test_" + std::to_string(::getpid());
};

TEST_F(BagTest, EachContainerGivesWhatWasPutIn) {
  const auto ros1 = messages(40, "sensor_msgs/Imu");
  test::write_file(path("a.bag"), test::Ros1BagMaker::make(ros1, 7));
  expect_holds(path("a.bag"), ros1, "sensor_msgs/Imu");
  const auto ros2 = messages(40, "sensor_msgs/msg/Imu");
  test::make_db3(path("a.db3"), ros2);
  expect_holds(path("a.db3"), ros2, "sensor_msgs/Imu");
  test::make_db3(path("z.db3"), ros2, true);
  expect_holds(path("z.db3"), ros2, "sensor_msgs/Imu");
  make_mcap("a.mcap", ros2);
  expect_holds(path("a.mcap"), ros2, "sensor_msgs/Imu");
}

/// Written by ROS 1 itself (rosbag of Debian 12), with its own compressions.
TEST_F(BagTest, BagsOfRosItselfAreReadWhole) {
  for (const char* name : {"lz4.bag", "bz2.bag"}) {
    const std::unique_ptr<Bag> bag = open(std::string{SLAMD_SOURCE_DIR "/tests/fuzz/corpus/fuzz_bag/"} + name);
    ASSERT_NE(bag, nullptr);
    const std::unique_ptr<BagCursor> cursor = bag->read(topic_named(*bag, "/imu"));
    EXPECT_EQ(hear(*cursor).size(), 40U);
    EXPECT_EQ(cursor->damage().places, 0U) << cursor->damage().first;
  }
}

TEST_F(BagTest, AFolderIsTheBagThatItsMetadataNames) {
  const auto sent = messages(40, "sensor_msgs/msg/Imu");
  const std::vector<SentMessage> first{sent.begin(), sent.begin() + 25}, second{sent.begin() + 25, sent.end()};
  test::make_db3(path("b_0.db3"), first);
  test::make_db3(path("b_1.db3"), second);
  test::write_file(path("metadata.yaml"), "rosbag2_bagfile_information:\n  relative_file_paths: [b_0.db3, b_1.db3]\n");
  expect_holds(folder_, sent, "sensor_msgs/Imu");
}

TEST_F(BagTest, ABagThatWasNeverClosedIsReadToItsEnd) {
  const auto sent = messages(40, "sensor_msgs/Imu");
  test::write_file(path("a.bag"), test::Ros1BagMaker::make(sent, 7, false));
  expect_holds(path("a.bag"), sent, "sensor_msgs/Imu");
}

TEST_F(BagTest, ARos1BagThatBreaksOffAnywhereGivesItsWholeMessages) {
  const auto sent = messages(40, "sensor_msgs/Imu");
  const std::string whole = test::Ros1BagMaker::make(sent, 7, false);
  std::size_t most = 0;
  for (std::size_t size = 13; size < whole.size(); size += 3) {
    test::write_file(path("cut.bag"), whole.substr(0, size));
    const std::size_t count = expect_nothing_else(path("cut.bag"), sent, "cut at " + std::to_string(size));
    ASSERT_GE(count, most) << "cut at " << size;
    most = count;
  }
  EXPECT_GE(most, 39U);
}

TEST_F(BagTest, AWrongByteInARos1BagCostsAtMostItsChunk) {
  const auto sent = messages(40, "sensor_msgs/Imu");
  const std::string whole = test::Ros1BagMaker::make(sent, 7);
  const std::size_t chunks_at = whole.find("compression=none") - 40;
  for (std::size_t at = chunks_at; at < whole.size(); at += 5) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    test::write_file(path("damaged.bag"), damaged);
    OpenedBag opened = open_bag(path("damaged.bag"));
    ASSERT_TRUE(std::holds_alternative<std::unique_ptr<Bag>>(opened)) << "byte " << at;
    const Bag& bag = *std::get<std::unique_ptr<Bag>>(opened);
    std::size_t count = 0;  // a ROS 1 bag has no checksums: a changed byte of a message cannot be seen
    for (std::size_t topic = 0; topic < bag.topics().size(); ++topic) count += hear(*bag.read(topic)).size();
    ASSERT_GE(count + 20, sent.size()) << "byte " << at;
  }
}

TEST_F(BagTest, AnSqliteFileThatBreaksOffGivesWhatCanBeRead) {
  const auto sent = messages(400, "sensor_msgs/msg/Imu");
  test::make_db3(path("a.db3"), sent);
  const std::string whole = text_of(path("a.db3"));
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); size += 1024) {
    test::write_file(path("cut.db3"), whole.substr(0, size));
    most = std::max(most, expect_nothing_else(path("cut.db3"), sent, "cut at " + std::to_string(size)));
  }
  EXPECT_GT(most, 300U);
}

TEST_F(BagTest, ADamagedPageOfAnSqliteFileCostsWhatLiesOnIt) {
  const auto sent = messages(400, "sensor_msgs/msg/Imu");
  test::make_db3(path("a.db3"), sent);
  const std::string whole = text_of(path("a.db3"));
  ASSERT_GT(whole.size(), 12U * 4096);
  std::string damaged = whole;
  std::fill_n(damaged.begin() + 8 * 4096, 100, '\x55');  // the head of a leaf
  test::write_file(path("damaged.db3"), damaged);
  const std::size_t count = expect_nothing_else(path("damaged.db3"), sent, "a page");
  EXPECT_GT(count, 340U);
  EXPECT_LT(count, 400U);
  const std::unique_ptr<Bag> bag = open(path("damaged.db3"));
  const std::unique_ptr<BagCursor> cursor = bag->read(topic_named(*bag, "/imu"));
  hear(*cursor);
  EXPECT_GT(cursor->damage().places, 0U);
  EXPECT_NE(cursor->damage().first.find("damaged.db3: behind message"), std::string::npos) << cursor->damage().first;
}

TEST_F(BagTest, WhatIsNoBagIsRefusedWithItsReason) {
  test::write_file(path("text"), "hello");
  EXPECT_NE(fault_of(path("text")).find("is no bag"), std::string::npos);
  test::write_file(path("old.bag"), "#ROSBAG V1.2\nrest");
  EXPECT_NE(fault_of(path("old.bag")).find("byte 0: is no ROS 1 bag of format 2.0"), std::string::npos);
  test::write_file(path("metadata.yaml"), "a: [");
  EXPECT_NE(fault_of(folder_).find("metadata.yaml:"), std::string::npos) << "with its line";
  test::write_file(path("metadata.yaml"), "rosbag2_bagfile_information:\n  compression_mode: FILE\n  relative_file_paths: [x.db3.zstd]\n");
  EXPECT_NE(fault_of(folder_).find("compressed as a whole"), std::string::npos);
  test::write_file(path("metadata.yaml"), "rosbag2_bagfile_information:\n  relative_file_paths: [gone.db3]\n");
  EXPECT_NE(fault_of(folder_).find("gone.db3: is missing"), std::string::npos);
  test::write_file(path("x.db3"), std::string{"SQLite format 3"} + std::string(3000, '\0'));
  EXPECT_NE(fault_of(path("x.db3")).find("x.db3: is no ROS 2 bag"), std::string::npos) << fault_of(path("x.db3"));
}

}  // namespace
}  // namespace slamd::replay
