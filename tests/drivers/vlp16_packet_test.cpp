#include "drivers/velodyne/vlp16_packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/drivers/vlp16_bytes.hpp"

namespace slamd {
namespace {

LidarRejection cause_of(const Vlp16Bytes& packet) {
  return parse_vlp16(packet.span()).cause;
}

TEST(Vlp16Packet, ReadsStampModeAzimuthsAndReturns) {
  Vlp16Bytes b{35990, 40, 3599999999U, 0x38};
  b.set_return(3, 17, 0xFFFE, 200);
  const auto [cause, packet] = parse_vlp16(b.span());
  ASSERT_EQ(cause, LidarRejection::kCount);
  EXPECT_EQ(packet.stamp_us, 3599999999U);
  EXPECT_EQ(packet.mode, Vlp16ReturnMode::kLast);
  EXPECT_EQ(packet.azimuth_cdeg[0], 35990);
  EXPECT_EQ(packet.azimuth_cdeg[1], 30);
  EXPECT_EQ(packet.at(3, 17).distance_2mm, 0xFFFE);
  EXPECT_EQ(packet.at(3, 17).intensity, 200);
  EXPECT_EQ(packet.at(3, 16).distance_2mm, 0);
}

TEST(Vlp16Packet, RefusesAzimuthsOfAFullCircleAndMore) {
  for (const auto& [azimuth, good] : {std::pair{0, true}, {35999, true}, {36000, false}, {65535, false}}) {
    for (const std::size_t block : {std::size_t{0}, std::size_t{11}}) {
      Vlp16Bytes b{100, 40, 0};
      b.set_azimuth(block, static_cast<std::uint16_t>(azimuth));
      EXPECT_EQ(cause_of(b), good ? LidarRejection::kCount : LidarRejection::kAzimuthRange) << azimuth;
    }
  }
}

TEST(Vlp16Packet, NamesOtherModelsByTheirProductByte) {
  using enum LidarRejection;
  for (const auto& [product, cause] : {std::pair{0x21, kHdl32e},
                                       {0x22, kCount},
                                       {0x24, kPuckHiRes},
                                       {0x28, kVlp32c},
                                       {0x31, kVelarray},
                                       {0xA1, kVls128},
                                       {0x00, kUnknownModel},
                                       {0xFF, kUnknownModel}}) {
    Vlp16Bytes b{0, 40, 0};
    b.bytes[1205] = static_cast<std::uint8_t>(product);
    EXPECT_EQ(cause_of(b), cause) << product;
  }
}

TEST(Vlp16Packet, KnowsAnHdl64ByItsLowerBlocksWhateverItsLastByte) {
  Vlp16Bytes b{0, 40, 0};
  b.bytes[100] = 0xFF;
  b.bytes[101] = 0xDD;
  EXPECT_EQ(cause_of(b), LidarRejection::kHdl64e);
  b.bytes[1205] = 'V';
  EXPECT_EQ(cause_of(b), LidarRejection::kHdl64e);
}

TEST(Vlp16Packet, RefusesWrongSizesModesFlagsAndStamps) {
  const Vlp16Bytes good{0, 40, 0};
  const std::vector<std::uint8_t> longer(1207);
  EXPECT_EQ(parse_vlp16(good.span().first(1205)).cause, LidarRejection::kWrongSize);
  EXPECT_EQ(parse_vlp16(longer).cause, LidarRejection::kWrongSize);
  EXPECT_EQ(parse_vlp16({}).cause, LidarRejection::kWrongSize);
  EXPECT_EQ(parse_vlp16(good.span().first(512)).cause, LidarRejection::kPositionPacket);
  for (const int mode : {0x00, 0x36, 0x3A, 0x3B, 0xFF}) {
    EXPECT_EQ(cause_of(Vlp16Bytes(0, 40, 0, static_cast<std::uint8_t>(mode))), LidarRejection::kReturnMode) << mode;
  }
  Vlp16Bytes flag{0, 40, 0};
  flag.bytes[701] = 0xEF;
  EXPECT_EQ(cause_of(flag), LidarRejection::kBlockFlag);
  EXPECT_EQ(cause_of(Vlp16Bytes(0, 40, 3'600'000'000U)), LidarRejection::kStampRange);
}

TEST(Vlp16Packet, RefusesADualReturnPairOfTwoAzimuths) {
  Vlp16Bytes b{0, 40, 0, 0x39};
  EXPECT_EQ(cause_of(b), LidarRejection::kCount);
  b.set_azimuth(5, 81);
  EXPECT_EQ(cause_of(b), LidarRejection::kPairMismatch);
}

TEST(Vlp16Packet, HasANameAndASentenceOfItsOwnForEveryCause) {
  std::vector<std::string> names;
  for (int i = 0; i < static_cast<int>(LidarRejection::kCount); ++i) {
    names.emplace_back(name(static_cast<LidarRejection>(i)));
    EXPECT_GT(std::string{explain(static_cast<LidarRejection>(i))}.size(), 20U);
    EXPECT_NE(names.back(), "none");
  }
  EXPECT_STREQ(name(LidarRejection::kWrongSize), "wrong_size");
  EXPECT_STREQ(name(LidarRejection::kVls128), "vls_128");
  EXPECT_STREQ(name(LidarRejection::kStopped), "stopped");
  EXPECT_STREQ(name(LidarRejection::kStampJump), "stamp_jump");
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

class Vlp16PositionPacket : public ::testing::Test {
 protected:
  void put(std::uint8_t pps, const std::string& nmea) {
    bytes_.assign(512, 0);
    bytes_[198] = 0x40;
    bytes_[199] = 0x42;
    bytes_[200] = 0x0F;  // 1,000,000 us
    bytes_[202] = pps;
    std::copy(nmea.begin(), nmea.end(), bytes_.begin() + 206);
  }
  std::vector<std::uint8_t> bytes_;
};

TEST_F(Vlp16PositionPacket, GivesStampPpsStateAndTheSentenceWithoutItsEnd) {
  put(2, "$GPRMC,081802.00,A*2E\r\n");
  const auto position = parse_vlp16_position(bytes_);
  ASSERT_TRUE(position);
  EXPECT_EQ(position->stamp_us, 1'000'000U);
  EXPECT_EQ(position->pps, PpsState::kLocked);
  EXPECT_EQ(position->nmea, "$GPRMC,081802.00,A*2E");
}

TEST_F(Vlp16PositionPacket, MayHoldNoSentenceOrOneThatFillsItToTheLastByte) {
  put(0, "");
  EXPECT_EQ(parse_vlp16_position(bytes_)->nmea, "");
  put(1, std::string(306, 'x'));
  EXPECT_EQ(parse_vlp16_position(bytes_)->nmea.size(), 306U);
}

TEST_F(Vlp16PositionPacket, IsRefusedWithWrongSizeStateOrStamp) {
  put(4, "");
  EXPECT_FALSE(parse_vlp16_position(bytes_));
  put(3, "");
  EXPECT_TRUE(parse_vlp16_position(bytes_));
  bytes_[201] = 0xFF;
  EXPECT_FALSE(parse_vlp16_position(bytes_));
  put(3, "");
  bytes_.pop_back();
  EXPECT_FALSE(parse_vlp16_position(bytes_));
}

}  // namespace
}  // namespace slamd
