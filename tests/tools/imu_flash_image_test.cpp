// UF2 files and flash images of imu-flash: what is taken and what is refused. The order of flashing is in flasher_test.

#include <gtest/gtest.h>

#include <cstring>

#include "tests/tools/uf2_bytes.hpp"
#include "tools/imu-flash/uf2.hpp"

namespace slamd::flash {
namespace {

using test::image_bytes;
using test::uf2_of;

std::string refusal_with(std::size_t block, std::size_t field_at, std::uint32_t value) {
  std::vector<std::uint8_t> file = uf2_of(image_bytes(2048));
  test::store_word(file, block * kUf2BlockBytes + field_at, value);
  return parse_uf2(file).refusal;
}

TEST(Uf2, AWholeFileGivesItsPagesInTheOrderOfAddresses) {
  const std::vector<std::uint8_t> content = image_bytes(5000);
  std::vector<std::uint8_t> file = uf2_of(content);
  std::swap_ranges(file.begin(), file.begin() + 512, file.begin() + 1024);  // blocks may come in any order
  const LoadedImage loaded = parse_uf2(file);
  ASSERT_TRUE(loaded) << loaded.refusal;
  ASSERT_EQ(loaded.image.pages.size(), 20U);
  for (std::size_t i = 0; i < content.size(); ++i) {
    ASSERT_EQ(loaded.image.pages[i / 256].bytes[i % 256], content[i]) << i;
    ASSERT_EQ(loaded.image.pages[i / 256].address, kFlashBegin + i / 256 * 256);
  }
}

TEST(Uf2, EveryFieldIsChecked) {
  EXPECT_NE(refusal_with(3, 0, 0x0A32'4654).find("block 3: wrong magic"), std::string::npos);
  EXPECT_NE(refusal_with(3, 4, 0).find("magic"), std::string::npos);
  EXPECT_NE(refusal_with(3, 508, 0).find("magic"), std::string::npos);
  EXPECT_NE(refusal_with(3, 8, 0).find("no family"), std::string::npos);
  EXPECT_NE(refusal_with(3, 8, 0x3000).find("packed file"), std::string::npos);
  EXPECT_NE(refusal_with(3, 12, 0x0FFF'FF00).find("outside"), std::string::npos);
  EXPECT_NE(refusal_with(3, 12, 0x1100'0000).find("outside"), std::string::npos);
  EXPECT_NE(refusal_with(3, 12, 0xFFFF'FF00).find("outside"), std::string::npos);
  EXPECT_NE(refusal_with(3, 12, kFlashBegin + 0x4001).find("multiple of 256"), std::string::npos);
  EXPECT_NE(refusal_with(3, 12, kFlashBegin).find("block 3: overlaps block 0"), std::string::npos);
  EXPECT_NE(refusal_with(3, 16, 477).find("payload"), std::string::npos);
  EXPECT_NE(refusal_with(3, 20, 2).find("twice"), std::string::npos);
  EXPECT_NE(refusal_with(3, 20, 8).find("beyond"), std::string::npos);
  EXPECT_NE(refusal_with(3, 24, 9).find("has 9 blocks"), std::string::npos);
  EXPECT_NE(refusal_with(3, 28, 0xE48B'FF57).find("wrong family"), std::string::npos);
  EXPECT_EQ(refusal_with(7, 12, kFlashBegin + kFlashBytes - 256), "");  // the last page of the flash
}

TEST(Uf2, EveryShorterFileIsRefused) {
  const std::vector<std::uint8_t> file = uf2_of(image_bytes(2048));
  for (std::size_t size = 0; size < file.size(); size += 64) {
    EXPECT_FALSE(parse_uf2(std::span{file}.first(size))) << size;
  }
}

TEST(Uf2, BlocksThatAreNotForTheFlashAreSkippedButCounted) {
  std::vector<std::uint8_t> file = uf2_of(image_bytes(2048));
  test::store_word(file, 5 * kUf2BlockBytes + 8, 1);
  const LoadedImage loaded = parse_uf2(file);
  ASSERT_TRUE(loaded) << loaded.refusal;
  EXPECT_EQ(loaded.image.pages.size(), 7U);
}

TEST(FlashImage, TheSecondStagesChecksumDecidesWhetherItStarts) {
  const std::string check = "123456789";  // the catalogue's check value of CRC-32/MPEG-2 is 0x0376E6E7
  ASSERT_EQ(test::crc32_mpeg2(std::vector<std::uint8_t>{check.begin(), check.end()}), 0x0376'E6E7U);
  std::vector<std::uint8_t> content = image_bytes(512);
  EXPECT_FALSE(image_of_binary(content).image.is_bootable());
  test::store_word(content, 252, test::crc32_mpeg2({content.data(), 252}));
  EXPECT_TRUE(image_of_binary(content).image.is_bootable());
  content[100] ^= 1;
  EXPECT_FALSE(image_of_binary(content).image.is_bootable());
}

TEST(FlashImage, RunsStayWithinASectorAndEndAtHoles) {
  FlashImage image = image_of_binary(image_bytes(3 * kSectorBytes)).image;
  image.pages.erase(image.pages.begin() + 20);
  const auto runs = image.runs();
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(runs[0].bytes.size(), kSectorBytes);
  EXPECT_EQ(runs[1].bytes.size(), 4 * kPageBytes);
  EXPECT_EQ(runs[2].address, kFlashBegin + 21 * kPageBytes);
  EXPECT_EQ(image.sectors(), (std::vector<std::uint32_t>{kFlashBegin, kFlashBegin + 4096, kFlashBegin + 8192}));
}

TEST(FlashImage, ABinaryIsFilledUpWithErasedBytes) {
  const LoadedImage loaded = image_of_binary(image_bytes(300));
  ASSERT_EQ(loaded.image.pages.size(), 2U);
  EXPECT_EQ(loaded.image.pages[1].bytes[43], image_bytes(300)[299]);
  EXPECT_EQ(loaded.image.pages[1].bytes[44], 0xFF);
  EXPECT_FALSE(image_of_binary({}));
}

}  // namespace
}  // namespace slamd::flash
