#include <gtest/gtest.h>
#include <lz4frame.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>

#include "drivers/mcap/byte_writer.hpp"
#include "drivers/mcap/mcap_reader.hpp"
#include "drivers/mcap/mcap_writer.hpp"

namespace slamd {
namespace {

struct Heard {
  std::uint16_t channel;
  std::uint64_t time_ns;
  Bytes bytes;
  bool operator==(const Heard&) const = default;
};

std::vector<Heard> hear(McapReader& reader) {
  std::vector<Heard> all;
  while (const McapMessage* message = reader.next()) {
    all.push_back({message->channel_id, message->log_time_ns, {message->bytes.begin(), message->bytes.end()}});
  }
  return all;
}

std::vector<Heard> hear(std::span<const std::uint8_t> file) {
  McapReader reader{file};
  return hear(reader);
}

class Mcap : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  /// Two channels, `messages` messages of 60 bytes and more in chunks of ten, closed or not.
  Bytes file(int messages, bool closed = true) {
    std::filesystem::remove(path_);
    Result<McapWriter> opened = McapWriter::open(path_, "ros2", "test");
    EXPECT_TRUE(opened);
    {
      McapWriter writer = std::move(opened).value();
      const std::uint16_t schema = writer.add_schema("a/msg/B", "ros2msg", "int32 x");
      const std::array channels{writer.add_channel(schema, "/one", "cdr"), writer.add_channel(0, "/two", "raw")};
      writer.attach("note.txt", "text/plain", Bytes{'h', 'i'}, 7);
      writer.add_metadata("m", {{"key", "value"}});
      sent_.clear();
      for (int i = 0; i < messages; ++i) {
        Bytes bytes(static_cast<std::size_t>(60 + i));
        std::iota(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(i));
        const Heard heard{channels[static_cast<std::size_t>(i % 2)], static_cast<std::uint64_t>(1'000 + i), bytes};
        writer.write(heard.channel, heard.time_ns, heard.bytes);
        sent_.push_back(heard);
        if (i % 10 == 9) {
          EXPECT_TRUE(writer.flush());
        }
      }
      EXPECT_TRUE(closed ? writer.finish() : writer.flush());
    }
    std::ifstream in{path_, std::ios::binary};
    const std::vector<char> text{std::istreambuf_iterator<char>{in}, {}};
    return {text.begin(), text.end()};
  }

  const std::string path_ = testing::TempDir() + "mcap_test_" + std::to_string(::getpid()) + ".mcap";
  std::vector<Heard> sent_;
};

TEST_F(Mcap, WhatIsWrittenIsRead) {
  const Bytes bytes = file(35);
  McapReader reader{bytes};
  EXPECT_EQ(hear(reader), sent_);
  EXPECT_EQ(reader.damage().first_reason, nullptr);
  EXPECT_TRUE(reader.is_closed());
  EXPECT_EQ(reader.channels().at(0).topic, "/one");
  EXPECT_EQ(reader.schemas().at(1).name, "a/msg/B");
}

TEST_F(Mcap, TheSummaryTellsTheContents) {
  const Bytes bytes = file(35);
  const McapContents contents = read_contents(bytes);
  EXPECT_TRUE(contents.has_summary);
  EXPECT_EQ(contents.channels.size(), 2U);
  EXPECT_EQ(contents.schemas.at(1).text, "int32 x");
  EXPECT_EQ(contents.messages, (std::map<std::uint16_t, std::uint64_t>{{0, 18}, {1, 17}}));
  Bytes damaged = bytes;
  damaged[damaged.size() - 40] ^= 1U;
  const McapContents counted = read_contents(damaged);
  EXPECT_FALSE(counted.has_summary);
  EXPECT_EQ(counted.messages, contents.messages) << "by going through it";
}

TEST_F(Mcap, AttachmentsAndMetadataComeBack) {
  const Bytes bytes = file(12);
  const auto attachment = find_attachment(bytes, "note.txt");
  ASSERT_TRUE(attachment);
  EXPECT_EQ((Bytes{attachment->bytes.begin(), attachment->bytes.end()}), (Bytes{'h', 'i'}));
  EXPECT_FALSE(find_attachment(bytes, "other"));
  ASSERT_TRUE(find_metadata(bytes, "m"));
  EXPECT_EQ(find_metadata(bytes, "m")->values.at("key"), "value");
}

TEST_F(Mcap, OnlyWantedChannelsAreHandedOut) {
  const Bytes bytes = file(20);
  McapReader reader{bytes, [](const McapChannel& channel) { return channel.topic == "/two"; }};
  const std::vector<Heard> heard = hear(reader);
  EXPECT_EQ(heard.size(), 10U);
  for (const Heard& one : heard) EXPECT_EQ(one.channel, 1);
}

TEST_F(Mcap, AFileThatWasNeverClosedIsReadToItsEnd) {
  const Bytes bytes = file(30, false);
  McapReader reader{bytes};
  EXPECT_EQ(hear(reader), sent_);
  EXPECT_FALSE(reader.is_closed());
}

TEST_F(Mcap, AFileThatBreaksOffAnywhereGivesABeginOfItsMessages) {
  const Bytes bytes = file(30, false);
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<Heard> heard = hear(std::span{bytes}.first(size));
    ASSERT_LE(heard.size(), sent_.size());
    ASSERT_TRUE(std::equal(heard.begin(), heard.end(), sent_.begin())) << "cut at " << size;
    ASSERT_GE(heard.size() + 10, most) << "what was whole before stays whole; a chunk breaks off at its compressor's block";
    most = std::max(most, heard.size());
  }
  EXPECT_GE(most, 20U);
}

TEST_F(Mcap, OneWrongByteAnywhereCostsAtMostOneChunk) {
  const Bytes bytes = file(30);
  const std::size_t data_end = bytes.size() - 900;  // behind it there is only the summary
  for (std::size_t at = 120; at < data_end; ++at) {
    Bytes damaged = bytes;
    damaged[at] ^= 0x55U;
    McapReader reader{damaged};
    const std::vector<Heard> heard = hear(reader);
    for (const Heard& one : heard) {
      ASSERT_NE(std::find_if(sent_.begin(), sent_.end(), [&](const Heard& s) { return s.bytes == one.bytes; }), sent_.end())
          << "byte " << at << ": a message that was never sent";
    }
    ASSERT_GE(heard.size() + 10, sent_.size()) << "byte " << at;
    ASSERT_TRUE(heard.size() == sent_.size() || reader.damage().first_reason != nullptr) << "byte " << at;
  }
}

TEST_F(Mcap, AFileIsNeverWrittenOver) {
  file(1);
  EXPECT_FALSE(McapWriter::open(path_, "", ""));
}

TEST_F(Mcap, AFullDiskIsTold) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  std::filesystem::create_symlink("/dev/full", path_);
  Result<McapWriter> opened = McapWriter::open(path_, "", "");
  EXPECT_FALSE(opened) << "exclusive: also no link is followed";
}

TEST(Compression, EachFormComesBackAndSaysWhenItIsCut) {
  Bytes plain(300'000);
  for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = static_cast<std::uint8_t>(i * i / 1000);
  Bytes lz4(LZ4F_compressFrameBound(plain.size(), nullptr));
  lz4.resize(LZ4F_compressFrame(lz4.data(), lz4.size(), plain.data(), plain.size(), nullptr));
  for (const auto& [form, packed] : {std::pair{Compression::kZstd, compress_zstd(plain)}, {Compression::kLz4, lz4}, {Compression::kNone, plain}}) {
    const Decompressed all = decompress(form, packed, plain.size());
    EXPECT_TRUE(all.whole);
    EXPECT_EQ(all.bytes, plain);
    const Decompressed limited = decompress(form, packed, plain.size() - 1);
    EXPECT_FALSE(limited.whole) << "more than is allowed";
    EXPECT_EQ(limited.bytes.size(), plain.size() - 1);
    if (form == Compression::kNone) continue;
    const Decompressed cut = decompress(form, std::span{packed}.first(packed.size() / 2), plain.size());
    EXPECT_FALSE(cut.whole);
    EXPECT_TRUE(std::equal(cut.bytes.begin(), cut.bytes.end(), plain.begin()));
  }
}

TEST(Compression, AFewBytesThatSayTheyAreAGibibyteTakeNoMemory) {
  const Bytes packed = compress_zstd(Bytes(1000));
  EXPECT_EQ(decompress(Compression::kZstd, packed, std::size_t{1} << 40U).bytes.size(), 1000U);
}

}  // namespace
}  // namespace slamd
