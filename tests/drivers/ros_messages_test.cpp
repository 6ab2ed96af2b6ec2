#include "drivers/ros/messages.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/ros/message_writer.hpp"

namespace slamd {
namespace {

constexpr std::int64_t kStamp_ns = 1'673'400'471'837'873'222;
constexpr std::array kEncodings{RosEncoding::kRos1, RosEncoding::kCdr};

MessageWriter imu(RosEncoding encoding) {
  MessageWriter writer{encoding};
  writer.header(kStamp_ns, "imu_link");
  for (int i = 0; i < 4 + 9 + 3 + 9 + 3 + 9; ++i) writer.put(static_cast<double>(i));
  return writer;
}

MessageWriter scan(RosEncoding encoding) {
  MessageWriter writer{encoding};
  writer.header(kStamp_ns, "laser").put_all(std::array{-1.0F, 1.0F, 0.5F, 0.01F, 0.1F, 0.2F, 10.0F});
  writer.count(3).put_all(std::array{1.0F, INFINITY, 2.0F}).count(0);
  return writer;
}

MessageWriter velodyne(RosEncoding encoding) {
  MessageWriter writer{encoding};
  writer.header(kStamp_ns, "velodyne").count(2);
  for (int i = 0; i < 2; ++i) {
    const std::vector<std::uint8_t> payload(1206, static_cast<std::uint8_t>(i + 1));
    writer.time_ns(kStamp_ns + i).raw(payload);
  }
  return writer;
}

MessageWriter cloud(RosEncoding encoding) {
  MessageWriter writer{encoding};
  writer.header(kStamp_ns, "x").put(std::uint32_t{1}).put(std::uint32_t{2}).count(2);
  writer.text("x").put(std::uint32_t{0}).put(std::uint8_t{7}).put(std::uint32_t{1});
  writer.text("intensity").put(std::uint32_t{4}).put(std::uint8_t{2}).put(std::uint32_t{1});
  writer.put(std::uint8_t{0}).put(std::uint32_t{5}).put(std::uint32_t{10});
  writer.byte_sequence(std::vector<std::uint8_t>(10, 9)).put(std::uint8_t{1});
  return writer;
}

MessageWriter fix(RosEncoding encoding) {
  MessageWriter writer{encoding};
  writer.header(kStamp_ns, "gps").put(std::int8_t{1}).put(std::uint16_t{1}).put_all(std::array{49.5, 8.25, 110.0});
  for (int i = 0; i < 9; ++i) writer.put(static_cast<double>(i));
  return MessageWriter{writer}.put(std::uint8_t{2});
}

TEST(RosMessages, ValuesComeBackInEitherEncoding) {
  for (const RosEncoding encoding : kEncodings) {
    const auto imu_back = read_message<ImuMessage>(imu(encoding).bytes(), encoding);
    ASSERT_TRUE(imu_back);
    EXPECT_EQ(imu_back->stamp_ns, kStamp_ns);
    EXPECT_EQ(imu_back->angular_velocity, (std::array{13.0, 14.0, 15.0}));
    EXPECT_EQ(imu_back->linear_acceleration, (std::array{25.0, 26.0, 27.0}));

    const auto scan_back = read_message<LaserScanMessage>(scan(encoding).bytes(), encoding);
    ASSERT_TRUE(scan_back);
    EXPECT_EQ(scan_back->angle_increment, 0.5F);
    EXPECT_EQ(scan_back->ranges.size(), 3U);
    EXPECT_EQ(scan_back->ranges[2], 2.0F);

    const auto velodyne_back = read_message<VelodyneScanMessage>(velodyne(encoding).bytes(), encoding);
    ASSERT_TRUE(velodyne_back);
    ASSERT_EQ(velodyne_back->packets.size(), 2U);
    EXPECT_EQ(velodyne_back->packets[1].stamp_ns, kStamp_ns + 1);
    EXPECT_EQ(velodyne_back->packets[1].payload[1205], 2);

    const auto cloud_back = read_message<PointCloud2Message>(cloud(encoding).bytes(), encoding);
    ASSERT_TRUE(cloud_back);
    EXPECT_EQ(cloud_back->width, 2U);
    ASSERT_EQ(cloud_back->fields.size(), 2U);
    EXPECT_EQ(cloud_back->fields[1].name, "intensity");
    EXPECT_EQ(cloud_back->bytes.size(), 10U);

    const auto fix_back = read_message<NavSatFixMessage>(fix(encoding).bytes(), encoding);
    ASSERT_TRUE(fix_back);
    EXPECT_EQ(fix_back->status, 1);
    EXPECT_EQ(fix_back->longitude_deg, 8.25);
    EXPECT_EQ(fix_back->covariance[8], 8.0);
    EXPECT_EQ(fix_back->covariance_type, 2);
  }
}

/// A Sentence as a ROS 2 recorder writes it, byte by byte: little-endian CDR, aligned behind the encapsulation.
TEST(RosMessages, CdrLiesAsTheStandardSays) {
  const std::vector<std::uint8_t> bytes{0, 1, 0, 0,  0x01, 0, 0, 0,  0x02, 0, 0, 0,  4, 0, 0, 0,  'g', 'p', 's', 0,
                                        4, 0, 0, 0,  '$',  'A', 'B', 0};
  const auto message = read_message<SentenceMessage>(bytes, RosEncoding::kCdr);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->stamp_ns, 1'000'000'002);
  EXPECT_EQ(message->sentence, "$AB");
  MessageWriter writer;
  writer.header(1'000'000'002, "gps").text("$AB");
  EXPECT_EQ(writer.bytes(), bytes);
}

TEST(RosMessages, BigEndianCdrIsRead) {
  const std::vector<std::uint8_t> bytes{0, 0, 0, 0,  0, 0, 0, 1,  0, 0, 0, 2,  0, 0, 0, 1,  0, 0, 0, 0,  0, 0, 0, 2,  'x', 0};
  const auto message = read_message<SentenceMessage>(bytes, RosEncoding::kCdr);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->stamp_ns, 1'000'000'002);
  EXPECT_EQ(message->sentence, "x");
}

TEST(RosMessages, DoublesAreAlignedToEightInCdrAndToFourInPlainCdr2) {
  for (const std::uint8_t scheme : {std::uint8_t{1}, std::uint8_t{7}}) {
    std::vector<std::uint8_t> bytes{0, scheme, 0, 0, 1, 2, 3, 4};
    if (scheme == 1) bytes.insert(bytes.end(), 4, 0);
    for (const std::uint8_t byte : std::bit_cast<std::array<std::uint8_t, 8>>(2.5)) bytes.push_back(byte);
    MessageReader reader{bytes, RosEncoding::kCdr};
    reader.number<std::uint32_t>();
    EXPECT_EQ(reader.f64(), 2.5);
    EXPECT_TRUE(reader.ok());
  }
}

TEST(RosMessages, AnUnknownEncapsulationIsRefused) {
  const std::vector<std::uint8_t> bytes{0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_FALSE(read_stamp_ns(bytes, RosEncoding::kCdr));
}

template <class Message>
void expect_every_cut_is_refused(const MessageWriter& writer, RosEncoding encoding, std::size_t not_needed) {
  const auto& bytes = writer.bytes();
  for (std::size_t size = 0; size + not_needed < bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut{bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
    ASSERT_FALSE(read_message<Message>(cut, encoding)) << Message::kType << " cut at " << size;
  }
}

TEST(RosMessages, AMessageThatBreaksOffAnywhereIsNone) {
  for (const RosEncoding encoding : kEncodings) {
    expect_every_cut_is_refused<ImuMessage>(imu(encoding), encoding, 9 * 8);  // the last covariance is not read
    expect_every_cut_is_refused<LaserScanMessage>(scan(encoding), encoding, 4);  // intensities
    expect_every_cut_is_refused<VelodyneScanMessage>(velodyne(encoding), encoding, 0);
    expect_every_cut_is_refused<PointCloud2Message>(cloud(encoding), encoding, 1);  // is_dense
    expect_every_cut_is_refused<NavSatFixMessage>(fix(encoding), encoding, 0);
  }
}

TEST(RosMessages, ALengthThatCannotBeTakesNoMemory) {
  MessageWriter writer{RosEncoding::kRos1};
  writer.header(0, "").count(0xFFFFFFFFU);
  EXPECT_FALSE(read_message<VelodyneScanMessage>(writer.bytes(), RosEncoding::kRos1));
}

TEST(RosMessages, TimesBefore1970AndMoreThanASecondOfNanosecondsAreRefused) {
  MessageWriter early;
  early.put(std::int32_t{-5}).put(std::uint32_t{0}).text("");
  EXPECT_FALSE(read_stamp_ns(early.bytes(), RosEncoding::kCdr));
  MessageWriter long_second;
  long_second.put(std::int32_t{5}).put(std::uint32_t{1'000'000'000}).text("");
  EXPECT_FALSE(read_stamp_ns(long_second.bytes(), RosEncoding::kCdr));
}

}  // namespace
}  // namespace slamd
